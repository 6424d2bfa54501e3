"""Stand-ins for ``launch.conditions``."""

from drake_twin.ros2.lazy_exports import classes_in, lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {**classes_in(__file__), "evaluate_condition_expression_impl": "evaluate_condition_expression"},
)
