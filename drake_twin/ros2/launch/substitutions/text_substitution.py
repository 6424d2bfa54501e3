"""Stand-ins for ``launch.substitutions.text_substitution``."""

from drake_twin.ros2.substitution import TextSubstitution

__all__ = ["TextSubstitution"]
