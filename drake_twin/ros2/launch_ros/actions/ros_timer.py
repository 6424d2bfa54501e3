"""A timer on ROS's clock."""

from drake_twin.ros2.launch.actions.timer_action import TimerAction
from drake_twin.ros2.launch.frontend.expose import expose_action

__all__ = ["ROSTimer", "RosTimer"]


@expose_action("ros_timer")
class RosTimer(TimerAction):
    """A timer on ROS's clock, which here is simulation time like every timer."""


ROSTimer = RosTimer
