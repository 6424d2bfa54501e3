"""Stand-ins for ``nav2_common.launch.has_node_params``."""

from drake_twin.ros2.rewritten_files import HasNodeParams

__all__ = ["HasNodeParams"]
