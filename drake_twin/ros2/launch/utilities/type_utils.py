"""Stand-ins for ``launch.utilities.type_utils``."""

from typing import Any

from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch_ros.parameter_descriptions import ParameterValue


def normalize_typed_substitution(value: Any, data_type: Any = None) -> Any:
    """Return the value as it is: `perform_typed_substitution` takes it in any form."""
    return value


def perform_typed_substitution(context: LaunchContext, value: Any, data_type: Any = None) -> Any:
    """Return the value that text or substitutions stand for, as a type; None for what YAML takes the text for."""
    return ParameterValue(value, value_type=data_type).evaluate(context)
