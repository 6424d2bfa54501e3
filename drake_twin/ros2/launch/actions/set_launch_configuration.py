"""Stand-ins for ``launch.actions.set_launch_configuration``."""

from drake_twin.ros2.actions import SetLaunchConfiguration

__all__ = ["SetLaunchConfiguration"]
