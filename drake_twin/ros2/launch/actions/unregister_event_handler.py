"""Stand-ins for ``launch.actions.unregister_event_handler``."""

from drake_twin.ros2.actions import UnregisterEventHandler

__all__ = ["UnregisterEventHandler"]
