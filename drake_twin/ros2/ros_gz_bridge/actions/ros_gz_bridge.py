"""Starts a bridge between ROS's and gz's topics."""

from drake_twin.ros2.built_in_action import BuiltInAction
from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.packages import BUILT_IN


@expose_action("ros_gz_bridge")
class RosGzBridge(BuiltInAction):
    """Starts a bridge between ROS's and gz's topics."""

    file = f"{BUILT_IN}/ros_gz_bridge/launch/ros_gz_bridge.launch.py"
    more_attributes = ("extra_bridge_params",)
