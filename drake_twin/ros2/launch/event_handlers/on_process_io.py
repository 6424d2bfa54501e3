"""Stand-ins for ``launch.event_handlers.on_process_io``."""

from drake_twin.ros2.event_handlers import OnProcessIO

__all__ = ["OnProcessIO"]
