"""Stand-ins for ``launch_ros.event_handlers.on_state_transition``."""

from drake_twin.ros2.event_handlers import OnStateTransition

__all__ = ["OnStateTransition"]
