"""Stand-ins for ``launch.event_handlers.on_action_event_base``."""

from drake_twin.ros2.event_handlers import OnActionEventBase

__all__ = ["OnActionEventBase"]
