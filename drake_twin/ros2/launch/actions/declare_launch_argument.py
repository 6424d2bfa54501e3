"""Stand-ins for ``launch.actions.declare_launch_argument``."""

from drake_twin.ros2.actions import DeclareLaunchArgument

__all__ = ["DeclareLaunchArgument"]
