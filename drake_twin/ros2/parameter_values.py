"""The values of parameters, by ROS's typing rules."""

import os
from collections.abc import Mapping, Sequence
from typing import Any

from drake_twin.errors import InputError
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import Substitution
from drake_twin.ros2.launched import ParameterValue as Value
from drake_twin.ros2.typed_text import (
    SCALARS,
    Typed,
    as_scalar,
    is_of_type,
    item_type,
    type_name,
    typed_items,
    typed_text,
)

_AS_TEXT = "; with ParameterValue(…, value_type=str) it is taken as text"


def typed_value(context: LaunchContext, value: Any, what: str) -> Value:
    """Return a value of a node's mapping of parameters: text and numbers as they are, substitutions as YAML takes them.

    Args:
        context: The context.
        value: A number, text, a substitution, or a list of them. Text and substitutions in a list are the parts of one
            text; a list in a list is one item.
        what: The value in words, for messages.

    Raises:
        InputError: If a parameter cannot have a value of this type.
    """
    if isinstance(value, bool | int | float | str | bytes) and not hasattr(value, "item"):
        return value
    if isinstance(value, Substitution):
        return _of_text(context, value, what)
    if isinstance(value, Sequence):
        return _of_sequence(context, value, what)
    if hasattr(value, "item"):  # a NumPy number
        context.refused_by_ros(f"{what} is a number of NumPy")
        return typed_value(context, value.item(), what)
    if isinstance(value, os.PathLike):
        context.refused_by_ros(f"{what} is a path object, which is not text")
        return str(value)
    raise InputError(f"{what} is {value!r}, of type {type(value).__name__}, which no parameter can have")


def _of_text(context: LaunchContext, value: Any, what: str) -> Value:
    typed = typed_text(context.perform_substitution(value))
    if typed.value == () or typed.value == []:
        typed = Typed((), "an empty list")
    return accepted(context, typed, what, _AS_TEXT if isinstance(typed.value, str) else "")


def _of_sequence(context: LaunchContext, values: Sequence[Any], what: str) -> Value:
    if not values:
        return accepted(context, Typed((), "an empty list"), what)
    if any(isinstance(value, Substitution) for value in values) and is_text(values):
        return _of_text(context, values, what)
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        floats = any(isinstance(value, float) for value in values)
        return tuple(float(value) if floats else value for value in values)
    items = []
    for value in values:
        if isinstance(value, Mapping):
            context.refused_by_ros(f"{what} is a list of mappings")
            value = str(value)
        elif isinstance(value, Substitution | Sequence) and not isinstance(value, str | bytes):
            value = _of_text(context, value, what)
        items.append(value)
    return accepted(context, typed_items(items), what)


def typed_as(context: LaunchContext, value: Any, kind: Any, what: str) -> Value:
    """Return a value of a type, as ``ParameterValue`` reads it.

    Args:
        context: The context.
        value: A number, text, a substitution, or a list of them.
        kind: ``bool``, ``int``, ``float``, ``str`` or a list of one of them; None for what YAML takes text for.
        what: The value in words, for messages.

    Raises:
        InputError: If it cannot be of the type.
    """
    if isinstance(value, os.PathLike) or hasattr(value, "item"):
        value = typed_value(context, value, what)
    if isinstance(value, SCALARS):
        if kind is None or is_of_type(value, kind):
            return value
        refused = f"{value!r}, and not of type {type_name(kind)}"
        if item_type(kind) is not None:
            return accepted(context, Typed(typed_text(str(value), kind).value, refused), what)
        return accepted(context, Typed(as_scalar(value, kind), refused), what)
    if isinstance(value, Substitution) or (is_text(value) and any(isinstance(part, Substitution) for part in value)):
        return accepted(context, typed_text(context.perform_substitution(value), kind), what)
    if kind is not None and item_type(kind) is None:
        refused = f"a list, and not of type {type_name(kind)}"
        return accepted(context, Typed(typed_text(context.perform_substitution(value), kind).value, refused), what)
    item = item_type(kind)
    items = []
    for each in value:
        if isinstance(each, Substitution | Sequence) and not isinstance(each, str):
            each = accepted(context, typed_text(context.perform_substitution(each), item), what)
        items.append(each)
    if item in (None, float) and {type(each) for each in items} == {int, float}:
        return tuple(float(each) for each in items)
    return accepted(context, typed_items(items, item), what)


def accepted(context: LaunchContext, typed: Typed, what: str, advice: str = "") -> Value:
    """Return a value; note that ROS refuses it, where it does."""
    if typed.refused:
        context.refused_by_ros(f"{what} is {typed.refused}{advice}")
    value: Value = tuple(typed.value) if isinstance(typed.value, list) else typed.value
    return value


def is_text(value: Any) -> bool:
    """Return whether a list is the parts of one text: strings, paths and substitutions."""
    return isinstance(value, list | tuple) and all(isinstance(part, str | os.PathLike | Substitution) for part in value)
