"""Stand-ins for ``launch.actions.execute_process``."""

from drake_twin.ros2.process_actions import ExecuteProcess

__all__ = ["ExecuteProcess"]
