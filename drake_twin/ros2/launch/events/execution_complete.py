"""Stand-ins for ``launch.events.execution_complete``."""

from drake_twin.ros2.events import ExecutionComplete

__all__ = ["ExecutionComplete"]
