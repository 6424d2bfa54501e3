"""Stand-ins for ``launch.substitution``."""

from drake_twin.ros2.substitution import Substitution

__all__ = ["Substitution"]
