"""Stand-ins for ``launch_ros.actions.set_ros_log_dir``."""

from drake_twin.ros2.ros_actions import SetROSLogDir

__all__ = ["SetROSLogDir"]
