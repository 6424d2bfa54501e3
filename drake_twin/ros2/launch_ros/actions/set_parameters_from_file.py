"""Stand-ins for ``launch_ros.actions.set_parameters_from_file``."""

from drake_twin.ros2.ros_actions import SetParametersFromFile

__all__ = ["SetParametersFromFile"]
