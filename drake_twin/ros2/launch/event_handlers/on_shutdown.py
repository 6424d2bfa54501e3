"""Stand-ins for ``launch.event_handlers.on_shutdown``."""

from drake_twin.ros2.event_handlers import OnShutdown

__all__ = ["OnShutdown"]
