"""Stand-ins for ``launch.event_handlers``."""

from drake_twin.ros2.lazy_exports import classes_in, lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {**classes_in(__file__), "event_named": "event_named", "launch.event_handler": "BaseEventHandler"},
)
