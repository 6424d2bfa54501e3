"""Stand-ins for ``launch.conditions``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "evaluate_condition_expression_impl": "evaluate_condition_expression",
        "if_condition": "IfCondition",
        "invalid_condition_expression_error": "InvalidConditionExpressionError",
        "launch_configuration_equals": "LaunchConfigurationEquals",
        "launch_configuration_not_equals": "LaunchConfigurationNotEquals",
        "unless_condition": "UnlessCondition",
    },
)
