"""Stand-ins for ``launch.actions.pop_launch_configurations``."""

from drake_twin.ros2.actions import PopLaunchConfigurations

__all__ = ["PopLaunchConfigurations"]
