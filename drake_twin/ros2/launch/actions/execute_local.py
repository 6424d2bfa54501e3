"""Stand-ins for ``launch.actions.execute_local``."""

from drake_twin.ros2.process_actions import ExecuteLocal

__all__ = ["ExecuteLocal"]
