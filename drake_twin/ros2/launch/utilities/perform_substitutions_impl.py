"""Stand-ins for ``launch.utilities.perform_substitutions_impl``."""

from drake_twin.ros2.substitution import perform_substitutions

__all__ = ["perform_substitutions"]
