"""Stand-ins for ``launch.substitutions.for_loop_var``."""

from drake_twin.ros2.substitutions import ForEachVar, ForLoopIndex

__all__ = ["ForEachVar", "ForLoopIndex"]
