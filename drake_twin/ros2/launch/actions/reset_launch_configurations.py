"""Stand-ins for ``launch.actions.reset_launch_configurations``."""

from drake_twin.ros2.actions import ResetLaunchConfigurations

__all__ = ["ResetLaunchConfigurations"]
