"""Stand-ins for ``launch.event_handlers.event_named``."""

from drake_twin.ros2.event_handlers import event_named

__all__ = ["event_named"]
