"""Stand-ins for ``launch.actions.push_launch_configurations``."""

from drake_twin.ros2.actions import PushLaunchConfigurations

__all__ = ["PushLaunchConfigurations"]
