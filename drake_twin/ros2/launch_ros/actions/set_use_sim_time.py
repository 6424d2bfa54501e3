"""Stand-ins for ``launch_ros.actions.set_use_sim_time``."""

from drake_twin.ros2.ros_actions import SetUseSimTime

__all__ = ["SetUseSimTime"]
