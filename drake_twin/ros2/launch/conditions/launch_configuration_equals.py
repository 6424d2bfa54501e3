"""Stand-ins for ``launch.conditions.launch_configuration_equals``."""

from drake_twin.ros2.conditions import LaunchConfigurationEquals

__all__ = ["LaunchConfigurationEquals"]
