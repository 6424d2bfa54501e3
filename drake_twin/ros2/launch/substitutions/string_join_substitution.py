"""Stand-ins for ``launch.substitutions.string_join_substitution``."""

from drake_twin.ros2.substitutions import StringJoinSubstitution

__all__ = ["StringJoinSubstitution"]
