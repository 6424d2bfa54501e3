"""Stand-ins for ``launch.utilities.normalize_to_list_of_entities_impl``."""

from drake_twin.ros2.entity import as_entities as normalize_to_list_of_entities

__all__ = ["normalize_to_list_of_entities"]
