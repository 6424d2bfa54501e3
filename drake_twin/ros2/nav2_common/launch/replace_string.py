"""Stand-ins for ``nav2_common.launch.replace_string``."""

from drake_twin.ros2.rewritten_files import ReplaceString

__all__ = ["ReplaceString"]
