"""Stand-ins for ``launch.event_handlers.on_process_exit``."""

from drake_twin.ros2.event_handlers import OnProcessExit

__all__ = ["OnProcessExit"]
