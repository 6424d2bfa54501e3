"""The parameters of a node."""

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from drake_twin.errors import InputError
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import Substitution
from drake_twin.ros2.launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue
from drake_twin.ros2.launched import ParameterText
from drake_twin.ros2.launched import ParameterValue as Value
from drake_twin.ros2.packages import AbsentError
from drake_twin.ros2.parameter_values import is_text, typed_value


def evaluate_parameters(
    context: LaunchContext, parameters: Any
) -> Iterator[Path | ParameterText | Mapping[str, Value]]:
    """Yield each entry of a node's ``parameters=``, evaluated.

    Raises:
        InputError: If an entry is not a file, a mapping or a parameter.
    """
    if parameters is None:
        return
    if isinstance(parameters, str | Mapping) or not isinstance(parameters, Iterable):
        raise InputError(f"parameters is a list of files and mappings, and this is a {type(parameters).__name__}")
    for entry in parameters:
        if isinstance(entry, Mapping):
            yield evaluate_parameters_dict(context, entry)
        elif isinstance(entry, Parameter):
            name, value = entry.evaluate_pair(context)
            yield {name: value}
        elif isinstance(entry, ParameterFile):
            yield entry.read(context)
        elif isinstance(entry, str | bytes | os.PathLike | Substitution):
            yield ParameterFile(entry).read(context)
        elif isinstance(entry, Iterable) and is_text(parts := [*entry]):  # a set, too, as ROS takes any iterable
            yield ParameterFile(parts).read(context)
        else:
            raise InputError(f"parameters holds files and mappings, and {entry!r} is of type {type(entry).__name__}")


def evaluate_parameters_dict(
    context: LaunchContext, parameters: Mapping[Any, Any], prefix: str = ""
) -> dict[str, Value]:
    """Return a mapping of parameters, evaluated; nested names are joined with a dot.

    Raises:
        InputError: If a value is not of its type, or of one that a parameter cannot have.
    """
    values: dict[str, Value] = {}
    for key, value in parameters.items():
        name = prefix + context.perform_substitution(key)
        if isinstance(value, Mapping):
            values.update(evaluate_parameters_dict(context, value, f"{name}."))
        elif isinstance(value, ParameterValue):
            values[name] = _named(name, value, context)
        else:
            values[name] = typed_value(context, value, f"parameter {name!r}")
    return values


def _named(name: str, value: ParameterValue, context: LaunchContext) -> Value:
    """Evaluate a value; an error names the parameter."""
    try:
        return value.evaluate(context, f"parameter {name!r}")
    except AbsentError:
        raise
    except InputError as error:
        if error.file is not None:
            raise
        raise InputError(f"parameter {name!r}: {error.message}", valid=error.valid, value=error.value) from None
