"""Stand-ins for ``launch.event_handlers.on_process_start``."""

from drake_twin.ros2.event_handlers import OnProcessStart

__all__ = ["OnProcessStart"]
