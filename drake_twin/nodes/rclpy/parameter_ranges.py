"""The ranges of parameters' descriptors."""

import math
from typing import Any

from drake_twin.nodes.rclpy.parameter import Parameter

PARAM_REL_TOL = 1e-6


def out_of_range(parameter: Parameter, descriptor: Any) -> str:
    """Return why a value is not in its descriptor's range; empty if it is, or without a range."""
    kind, value, name = parameter.type_, parameter.value, parameter.name
    if kind is Parameter.Type.INTEGER and descriptor.integer_range:
        lowest, highest, step = _bounds(descriptor.integer_range[0])
        text = f"Min: {lowest}, Max: {highest}, value: {value}"
        if value in (lowest, highest):
            return ""
        if not lowest < value < highest:
            return f"Parameter {name} out of range. {text}"
        if step and (value - lowest) % step:
            return f"The parameter value for {name} is not a valid step. {text.replace('Max', 'max')}, step: {step}"
    if kind is Parameter.Type.DOUBLE and descriptor.floating_point_range:
        lowest, highest, step = _bounds(descriptor.floating_point_range[0])
        text = f"Min: {lowest}, Max: {highest}, value: {value}"
        if math.isclose(value, lowest, rel_tol=PARAM_REL_TOL) or math.isclose(value, highest, rel_tol=PARAM_REL_TOL):
            return ""
        if not lowest < value < highest:
            return f"Parameter {name} out of range {text}"
        if step and not math.isclose(lowest + round((value - lowest) / step) * step, value, rel_tol=PARAM_REL_TOL):
            text = f"{text.replace('Max', 'max')}, step: {step}"
            return f"The parameter value for {name} is not close enough to a valid step. {text}"
    return ""


def _bounds(given: Any) -> tuple[Any, Any, Any]:
    return min(given.from_value, given.to_value), max(given.from_value, given.to_value), given.step
