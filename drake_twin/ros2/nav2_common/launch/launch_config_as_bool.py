"""Stand-ins for ``nav2_common.launch.launch_config_as_bool``."""

from drake_twin.ros2.rewritten_files import LaunchConfigAsBool

__all__ = ["LaunchConfigAsBool"]
