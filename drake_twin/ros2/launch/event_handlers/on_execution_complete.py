"""Stand-ins for ``launch.event_handlers.on_execution_complete``."""

from drake_twin.ros2.event_handlers import OnExecutionComplete

__all__ = ["OnExecutionComplete"]
