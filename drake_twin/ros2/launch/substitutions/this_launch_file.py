"""The path of the launch file, and its folder."""

import os

from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import Substitution
from drake_twin.ros2.launch.substitutions.substitution_failure import SubstitutionFailure


@expose_substitution("filename")
class ThisLaunchFile(Substitution):
    """The path of the launch file."""

    def perform(self, context: LaunchContext) -> str:
        """Return the path.

        Raises:
            SubstitutionFailure: If no launch file is being executed.
        """
        if context.current_launch_file is None:
            raise SubstitutionFailure("no launch file is being executed here")
        return context.current_launch_file


@expose_substitution("dirname")
class ThisLaunchFileDir(ThisLaunchFile):
    """The folder of the launch file."""

    def perform(self, context: LaunchContext) -> str:
        """Return the folder.

        Raises:
            InputError: If no launch file is being executed.
        """
        return os.path.dirname(super().perform(context))
