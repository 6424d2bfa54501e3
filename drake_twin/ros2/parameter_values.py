"""The values of parameters, by ROS's typing rules."""

import os
import typing
from collections.abc import Iterable, Sequence
from typing import Any

import yaml

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.errors import InputError
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import Substitution
from drake_twin.ros2.launched import ParameterValue as Value
from drake_twin.ros2.launched import Scalar

_SCALARS = (bool, int, float, str, bytes)


def typed_value(context: LaunchContext, value: Any, what: str) -> Value:
    """Return a value by ROS's rules: numbers and text as they are, what a substitution gives as YAML takes it.

    Text that YAML refuses (a URDF with a colon in a comment, say) stays text, with a warning, where ROS refuses it.

    Args:
        context: The context.
        value: A number, text, a substitution, a path or a list of them.
        what: The value in words, for messages.

    Raises:
        InputError: If a parameter cannot have a value of this type.
    """
    if isinstance(value, bool | int | float | str | bytes):
        return value
    if isinstance(value, Substitution):
        return _yaml_value(context, context.perform_substitution(value), what)
    if isinstance(value, os.PathLike):
        return str(value)
    if isinstance(value, Sequence):
        return _sequence_value(context, value, what)
    if hasattr(value, "item"):  # a NumPy number
        return typed_value(context, value.item(), what)
    raise InputError(f"{what} is {value!r}, of type {type(value).__name__}, which no parameter can have")


def _sequence_value(context: LaunchContext, values: Sequence[Any], what: str) -> Value:
    if not values:
        return ()
    if any(isinstance(value, Substitution) for value in values) and is_text(values):
        return _yaml_value(context, context.perform_substitution(values), what)  # the parts of one text
    kinds = {type(value) for value in values}
    if kinds <= {bool, int, float}:
        return _uniform(list(values))
    items = [
        _yaml_scalar(context.perform_substitution(value))
        if isinstance(value, Sequence) and not isinstance(value, str)
        else value
        for value in values
    ]
    return _uniform(items)


def _uniform(values: Sequence[Any]) -> Value:
    kinds = {type(value) for value in values}
    if len(kinds) == 1 and kinds <= {bool, int, float, str}:
        return tuple(values)
    if kinds <= {int, float}:
        return tuple(float(value) for value in values)
    return tuple(str(value) for value in values)


def _yaml_value(context: LaunchContext, text: str, what: str) -> Value:
    if not text:
        return ""
    if text.lstrip().startswith("<"):  # a robot description
        return _description(context, text, what)
    try:
        value = load_yaml(text)
    except yaml.YAMLError:
        context.log.append(
            f"{what} is text that is not valid YAML, which ROS refuses without ParameterValue(…, value_type=str)"
        )
        return text
    if isinstance(value, _SCALARS):
        return value
    if isinstance(value, list) and value and all(isinstance(item, _SCALARS) for item in value):
        return _uniform(value)
    return text


def _description(context: LaunchContext, text: str, what: str) -> str:
    try:
        plain = isinstance(load_yaml(text), str)
    except yaml.YAMLError:
        plain = False
    if not plain:
        context.log.append(
            f"{what} is XML that YAML misreads, which ROS refuses without ParameterValue(…, value_type=str)"
        )
    return text


def _yaml_scalar(text: str) -> Any:
    try:
        value = load_yaml(text)
    except yaml.YAMLError:
        return text
    return value if isinstance(value, _SCALARS) else text


def as_type(value: Any, kind: Any) -> Value:
    """Return text (or a number) as a type, or a list of a type.

    Raises:
        InputError: If it is of another type.
    """
    if typing.get_origin(kind) is not None and isinstance(value, str):
        items = load_yaml(value)
        if not isinstance(items, list):
            raise InputError(f"{value!r} is not a list, which the parameter's type asks for")
        return items_as(items, kind)
    return _scalar_as(value, kind)


def items_as(items: Iterable[Any], kind: Any) -> tuple[Scalar, ...]:
    """Return items as ``x`` of ``list[x]``.

    Raises:
        InputError: If one is of another type.
    """
    arguments = typing.get_args(kind)
    return tuple(_scalar_as(item, arguments[0] if arguments else str) for item in items)


def _scalar_as(value: Any, kind: Any) -> Scalar:
    if kind is str:
        return str(value)
    plain = load_yaml(value) if isinstance(value, str) else value
    if kind is bool and isinstance(plain, bool):
        return plain
    if kind is int and isinstance(plain, int) and not isinstance(plain, bool):
        return plain
    if kind is float and isinstance(plain, int | float) and not isinstance(plain, bool):
        return float(plain)
    if kind is float and isinstance(plain, str):
        try:
            return float(plain)  # YAML 1.1 takes 1e-3 for text
        except ValueError:
            pass
    name = getattr(kind, "__name__", str(kind))
    raise InputError(f"{value!r} is not of the parameter's type, {name}")


def is_text(value: Any) -> bool:
    """Return whether a list is the parts of one text: strings, paths and substitutions."""
    return isinstance(value, list | tuple) and all(isinstance(part, str | os.PathLike | Substitution) for part in value)
