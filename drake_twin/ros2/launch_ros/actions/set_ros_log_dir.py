"""Sets the folder of the log files."""

from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType


@expose_action("set_ros_log_dir")
class SetROSLogDir(Action):
    """Sets the folder of the log files."""

    _required = ("new_log_dir",)

    def __init__(self, new_log_dir: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.new_log_dir = new_log_dir

    def execute(self, context: LaunchContext) -> None:
        """Set the folder."""
        context.environment["ROS_LOG_DIR"] = context.perform_substitution(self.new_log_dir)
