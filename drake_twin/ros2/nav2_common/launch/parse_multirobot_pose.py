"""Stand-ins for ``nav2_common.launch.parse_multirobot_pose``."""

from drake_twin.ros2.rewritten_files import ParseMultiRobotPose

__all__ = ["ParseMultiRobotPose"]
