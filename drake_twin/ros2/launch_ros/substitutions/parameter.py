"""Stand-ins for ``launch_ros.substitutions.parameter``."""

from drake_twin.ros2.substitutions import Parameter

__all__ = ["Parameter"]
