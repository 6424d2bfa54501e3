"""Stand-ins for ``launch.substitutions.path_join_substitution``."""

from drake_twin.ros2.substitutions import PathJoinSubstitution, PathSubstitution

__all__ = ["PathJoinSubstitution", "PathSubstitution"]
