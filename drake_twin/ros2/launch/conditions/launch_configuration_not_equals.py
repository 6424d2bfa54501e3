"""Stand-ins for ``launch.conditions.launch_configuration_not_equals``."""

from drake_twin.ros2.conditions import LaunchConfigurationNotEquals

__all__ = ["LaunchConfigurationNotEquals"]
