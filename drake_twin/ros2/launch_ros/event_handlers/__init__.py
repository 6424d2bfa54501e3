"""Stand-ins for ``launch_ros.event_handlers``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "on_state_transition": "OnStateTransition",
    },
)
