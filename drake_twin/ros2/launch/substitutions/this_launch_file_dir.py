"""The folder of the launch file."""

import os

from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitutions.this_launch_file import ThisLaunchFile


@expose_substitution("dirname")
class ThisLaunchFileDir(ThisLaunchFile):
    """The folder of the launch file."""

    def perform(self, context: LaunchContext) -> str:
        """Return the folder.

        Raises:
            InputError: If no launch file is being executed.
        """
        return os.path.dirname(super().perform(context))
