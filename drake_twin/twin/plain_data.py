"""Conversion of frozen values to plain data that JSON keeps without loss, and back: controllers' memories, messages.

A mapping with the key ``!`` represents a value that JSON lacks: a tuple, an array, a number that is not finite, a saved
class of this package by its registered name and version, a ROS message. Numbers are restored to the last bit.
"""

import types
import typing
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from math import isfinite
from typing import Any

import numpy as np

from drake_twin import messages
from drake_twin.errors import InputError
from drake_twin.saved import SAVED_CLASSES, saved_name


def to_plain(value: Any) -> Any:
    """Return a value as plain data.

    Raises:
        TypeError: If the value is of another kind than those above.
    """
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return float(value) if isfinite(value) else {"!": "float", "value": repr(float(value))}
    if isinstance(value, np.ndarray):
        return {
            "!": "array",
            "type": value.dtype.str,
            "shape": list(value.shape),
            "data": to_plain(value.ravel().tolist()),
        }
    if isinstance(value, np.generic):
        return to_plain(value.item())
    if hasattr(value, "__msgtype__"):
        return {"!": value.__msgtype__, **{item.name: to_plain(getattr(value, item.name)) for item in fields(value)}}
    if is_dataclass(value) and not isinstance(value, type):
        return {
            "!": saved_name(type(value)),
            **{item.name: to_plain(getattr(value, item.name)) for item in fields(value) if item.init},
        }
    if isinstance(value, tuple):
        if hasattr(value, "_fields"):
            return {"!": saved_name(type(value)), "items": [to_plain(item) for item in value]}
        return {"!": "tuple", "items": [to_plain(item) for item in value]}
    if isinstance(value, list):
        return [to_plain(item) for item in value]
    if isinstance(value, Mapping):
        return {"!": "mapping", "items": [[to_plain(key), to_plain(item)] for key, item in value.items()]}
    raise TypeError(f"{type(value).__name__} has no plain form")


def from_plain(data: Any) -> Any:
    """Return the value that plain data represents.

    Raises:
        InputError: If the data does not come from `to_plain`.
    """
    if isinstance(data, list):
        return [from_plain(item) for item in data]
    if not isinstance(data, dict):
        return data
    try:
        return _special(data["!"], {key: item for key, item in data.items() if key != "!"})
    except (KeyError, TypeError, ValueError, OverflowError, AttributeError, ImportError) as error:
        raise InputError(f"{messages.shortened(data)} is not a saved value ({error})") from None


def _special(kind: str, data: dict[str, Any]) -> Any:
    if kind == "float":
        return float(data["value"])
    if kind == "tuple":
        return tuple(from_plain(item) for item in data["items"])
    if kind == "mapping":
        return {from_plain(key): from_plain(item) for key, item in data["items"]}
    if kind == "array":
        return np.array(from_plain(data["data"]), dtype=np.dtype(data["type"])).reshape(data["shape"])
    if "/" in kind and "@" not in kind:
        return messages.type_store().types[kind](**{key: from_plain(item) for key, item in data.items()})
    found: Any = SAVED_CLASSES.get(kind)
    if found is None:
        raise ValueError(f"{kind} is not a class with saved values")
    name = found.__name__
    if hasattr(found, "_fields"):
        value = found(*(from_plain(item) for item in data["items"]))
        names: Iterable[str] = found._fields
    else:
        value = found(**{key: _of_kind(_hints(found).get(key), from_plain(item)) for key, item in data.items()})
        names = [item.name for item in fields(found)]
    hints = _hints(found)
    for field in names:
        if not _fits(getattr(value, field), hints.get(field, Any)):
            raise ValueError(f"{messages.shortened(getattr(value, field))} is not a valid {field} of {name}")
    return value


def _of_kind(hint: Any, value: Any) -> Any:
    """Return an entry; JSON has only the text of a named value, such as a finding's kind."""
    return hint(value) if isinstance(hint, type) and issubclass(hint, Enum) else value


@cache
def _hints(kind: Any) -> dict[str, Any]:
    return typing.get_type_hints(kind)


def _fits(value: Any, hint: Any) -> bool:
    """Return whether a value is of an annotated type; true if that cannot be checked."""
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if hint is Any or isinstance(hint, typing.TypeVar):
        return True
    if hint is None or hint is type(None):
        return value is None
    if origin in (typing.Union, types.UnionType):
        return any(_fits(value, each) for each in arguments)
    if origin is typing.Literal:
        return value in arguments
    if origin is tuple:
        if not isinstance(value, tuple):
            return False
        if len(arguments) == 2 and arguments[1] is Ellipsis:
            return all(_fits(item, arguments[0]) for item in value)
        return len(value) == len(arguments) and all(map(_fits, value, arguments))
    if hint is float:
        return isinstance(value, float) or (
            isinstance(value, int) and not isinstance(value, bool) and abs(value) < 2**53
        )
    if hint is int:
        return isinstance(value, int) and not isinstance(value, bool)
    kind = origin or hint
    return isinstance(value, kind) if isinstance(kind, type) else True
