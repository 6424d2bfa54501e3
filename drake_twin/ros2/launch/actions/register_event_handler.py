"""Stand-ins for ``launch.actions.register_event_handler``."""

from drake_twin.ros2.actions import RegisterEventHandler

__all__ = ["RegisterEventHandler"]
