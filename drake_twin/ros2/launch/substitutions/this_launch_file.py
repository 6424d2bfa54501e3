"""The path of the launch file."""

from drake_twin.errors import InputError
from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import Substitution


@expose_substitution("filename")
class ThisLaunchFile(Substitution):
    """The path of the launch file."""

    def perform(self, context: LaunchContext) -> str:
        """Return the path.

        Raises:
            InputError: If no launch file is being executed.
        """
        if context.current_launch_file is None:
            raise InputError("no launch file is being executed here")
        return context.current_launch_file
