"""The folder of the log files."""

import os

from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import Substitution


@expose_substitution("launch_log_dir")
@expose_substitution("log_dir")
class LaunchLogDir(Substitution):
    """The folder of the log files."""

    def perform(self, context: LaunchContext) -> str:
        """Return the folder."""
        home = context.environment.get("ROS_HOME") or os.path.expanduser("~/.ros")
        return context.environment.get("ROS_LOG_DIR") or os.path.join(home, "log")
