"""A launch configuration as a truth value."""

from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import Substitution


class LaunchConfigAsBool(Substitution):
    """A launch configuration as ``True`` or ``False``."""

    def __init__(self, name: str):
        self.name = name

    def perform(self, context: LaunchContext) -> str:
        """Return ``True`` or ``False``."""
        return str(str(context.launch_configurations.get(self.name, "")).lower() in ("true", "1", "yes", "on"))
