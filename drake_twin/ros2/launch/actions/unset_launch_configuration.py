"""Stand-ins for ``launch.actions.unset_launch_configuration``."""

from drake_twin.ros2.actions import UnsetLaunchConfiguration

__all__ = ["UnsetLaunchConfiguration"]
