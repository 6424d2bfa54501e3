"""Stand-ins for ``launch.substitutions.substitution_failure``."""

from drake_twin.ros2.substitution import SubstitutionFailure

__all__ = ["SubstitutionFailure"]
