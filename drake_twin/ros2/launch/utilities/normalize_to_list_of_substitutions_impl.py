"""Stand-ins for ``launch.utilities.normalize_to_list_of_substitutions_impl``."""

from drake_twin.ros2.substitution import normalize_to_list_of_substitutions

__all__ = ["normalize_to_list_of_substitutions"]
