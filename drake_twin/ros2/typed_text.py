"""What ROS takes the text of a launch file for: YAML's types, and lists of one type.

The rules are those of ``launch.utilities.type_utils``. Where ROS refuses a text that can only mean one thing, the
answer holds both: the value, and why ROS refuses it.
"""

import re
import typing
from collections.abc import Sequence
from typing import Any

import yaml

from drake_twin.dataclass import dataclass
from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.errors import InputError

SCALARS = (bool, int, float, str)

# A text without these is a plain scalar of YAML from its first to its last line.
_NOT_PLAIN = re.compile(r":(\s|$)|\s#|\t|^(---|\.\.\.)", re.MULTILINE)


@dataclass(frozen=True)
class Typed:
    """A value, and why ROS refuses it; empty where ROS takes it, too."""

    value: Any
    refused: str = ""


def item_type(kind: Any) -> Any:
    """Return ``x`` of ``list[x]``; None for another type."""
    return (typing.get_args(kind) or (str,))[0] if typing.get_origin(kind) is list or kind is list else None


def is_of_type(value: Any, kind: Any, *, can_be_str: bool = False) -> bool:
    """Return whether a value is of a type, as ROS checks it: an int does not count as a float, and a list has one type.

    Args:
        value: The value.
        kind: ``bool``, ``int``, ``float``, ``str``, a list of one of them, or None for any of these.
        can_be_str: Whether text is allowed, too, also in lists.
    """
    item = item_type(kind)
    if kind is None and isinstance(value, list):
        item = next((type(each) for each in value if type(each) is not str), str)
    if item is not None:
        allowed = (item, str) if can_be_str else item
        return isinstance(value, list) and item in SCALARS and all(isinstance(each, allowed) for each in value)
    return isinstance(value, SCALARS if kind is None else (kind, str) if can_be_str else kind)


def typed_text(text: str, kind: Any = None, *, can_be_str: bool = False) -> Typed:
    """Return what a text stands for.

    Args:
        text: The text.
        kind: See `is_of_type`; None for what YAML takes the text for.
        can_be_str: Whether text that is not of the type stays text, as it may hold substitutions.

    Raises:
        InputError: If the text cannot be of the type.
    """
    if kind is None:
        return _best(text, can_be_str)
    if item_type(kind) is not None:
        return _list(text, kind, can_be_str)
    if kind is str:
        return Typed(text)
    if kind in (int, float):
        try:
            return Typed(kind(text))
        except ValueError:
            pass
    elif kind is bool:
        value = _loaded({"1": "true", "0": "false"}.get(text, text))
        if isinstance(value, bool):
            return Typed(value)
    else:
        raise InputError(f"{type_name(kind)} is not a type of parameters", valid=[type_name(each) for each in SCALARS])
    if can_be_str:
        return Typed(text)
    raise InputError(f"{text!r} is not of the parameter's type, {type_name(kind)}")


def typed_items(items: Sequence[Any], kind: Any = None) -> Typed:
    """Return values as a list of one type.

    Args:
        items: The values.
        kind: The type of one; None for any.

    Raises:
        InputError: If one cannot be of the type.
    """
    values = list(items)
    if is_of_type(values, None if kind is None else list[kind]):
        return Typed(values)
    shown = ", ".join(map(repr, values[:5])) + (", …" if len(values) > 5 else "")
    if kind is None:
        return Typed(uniform(values), f"a list of different types, [{shown}]")
    return Typed([as_scalar(value, kind) for value in values], f"[{shown}], and not of type list[{type_name(kind)}]")


def uniform(values: Sequence[Any]) -> list[Any]:
    """Return values of different types as floats, or else as text."""
    if {type(value) for value in values} <= {int, float}:
        return [float(value) for value in values]
    return [str(value) for value in values]


def as_scalar(value: Any, kind: Any) -> Any:
    """Return a value as another type that can hold it.

    Raises:
        InputError: If the type cannot.
    """
    if isinstance(value, str) or kind is str:
        return typed_text(str(value), kind).value
    if kind is float and not isinstance(value, bool):
        return float(value)
    if isinstance(value, kind) and not (kind is int and isinstance(value, bool)):
        return value
    raise InputError(f"{value!r} is not of the parameter's type, {type_name(kind)}")


def _best(text: str, can_be_str: bool) -> Typed:
    if not text or (text.lstrip().startswith("<") and not _NOT_PLAIN.search(text)):
        return Typed(text)  # a robot description is long
    value = _loaded(text)
    if value is _NOT_YAML:
        return Typed(text, "" if can_be_str else "text that is not valid YAML")
    if is_of_type(value, None, can_be_str=can_be_str):
        return Typed(value)
    if isinstance(value, list) and all(isinstance(item, SCALARS) for item in value):
        return typed_items(value)
    return Typed(text, f"text that YAML takes for {_what(value)}")


def _list(text: str, kind: Any, can_be_str: bool) -> Typed:
    values = _loaded(text)
    if not isinstance(values, list):
        if can_be_str:
            return Typed(text)
        raise InputError(f"{text!r} is not a list, which the parameter's type asks for")
    if is_of_type(values, kind, can_be_str=can_be_str):
        return Typed(values)
    return typed_items(values, item_type(kind))


_NOT_YAML = object()


def _loaded(text: str) -> Any:
    try:
        return load_yaml(text)
    except yaml.YAMLError:
        return _NOT_YAML


def _what(value: Any) -> str:
    if value is None:
        return "nothing"
    names: dict[type, str] = {dict: "a mapping", list: "a list of lists or mappings"}
    return names.get(type(value), f"a {type(value).__name__}")


def type_name(kind: Any) -> str:
    """Return a type's name in words."""
    return getattr(kind, "__name__", str(kind)) if item_type(kind) is None else str(kind)
