"""Stand-ins for ``launch.utilities``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "normalize_to_list_of_entities_impl": "normalize_to_list_of_entities",
        "normalize_to_list_of_substitutions_impl": "normalize_to_list_of_substitutions",
        "perform_substitutions_impl": "perform_substitutions",
        "visit_all_entities_and_collect_futures_impl": "visit_all_entities_and_collect_futures",
    },
)
