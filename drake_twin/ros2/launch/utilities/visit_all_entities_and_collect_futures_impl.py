"""Stand-ins for ``launch.utilities.visit_all_entities_and_collect_futures_impl``."""

from drake_twin.ros2.entity import visit_all_entities_and_collect_futures

__all__ = ["visit_all_entities_and_collect_futures"]
