"""Stand-ins for ``nav2_common.launch.rewritten_yaml``."""

from drake_twin.ros2.rewritten_files import RewrittenYaml

__all__ = ["RewrittenYaml"]
