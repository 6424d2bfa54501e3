"""Stand-ins for ``launch_ros.actions.ros_timer``."""

from drake_twin.ros2.ros_actions import RosTimer
from drake_twin.ros2.ros_actions import RosTimer as ROSTimer

__all__ = ["ROSTimer", "RosTimer"]
