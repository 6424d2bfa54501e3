"""Stand-ins for ``launch.substitutions.local_substitution``."""

from drake_twin.ros2.substitutions import LocalSubstitution

__all__ = ["LocalSubstitution"]
