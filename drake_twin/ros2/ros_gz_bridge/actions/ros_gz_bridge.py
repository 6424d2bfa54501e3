"""Stand-ins for ``ros_gz_bridge.actions.ros_gz_bridge``."""

from drake_twin.ros2.gz_actions import RosGzBridge

__all__ = ["RosGzBridge"]
