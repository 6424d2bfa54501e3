"""Conversion of frozen values to plain data that JSON keeps without loss, and back: controllers' memories, messages.

A mapping with the key ``!`` represents a value that JSON lacks: a tuple, an array, a number that is not finite, a saved
class of this package by its registered name and version, a ROS message. Numbers are restored to the last bit.
"""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from math import isfinite
from typing import Any

import numpy as np

from drake_twin import messages
from drake_twin.errors import InputError
from drake_twin.messages.store import store_with
from drake_twin.saved import SAVED_CLASSES, saved_name
from drake_twin.typed_data import field_types, misfit


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
        return store_with(kind).types[kind](**{key: from_plain(item) for key, item in data.items()})
    found: Any = SAVED_CLASSES.get(kind)
    if found is None:
        raise ValueError(f"{kind} is not a class with saved values")
    name, kinds = found.__name__, field_types(found)
    if hasattr(found, "_fields"):
        value = found(*(from_plain(item) for item in data["items"]))
    else:
        value = found(**{key: _of_kind(kinds.get(key), from_plain(item)) for key, item in data.items()})
    for field, kind_of_field in kinds.items():
        if misfit(kind_of_field, getattr(value, field), (tuple, list)) is not None:
            raise ValueError(f"{messages.shortened(getattr(value, field))} is not a valid {field} of {name}")
    return value


def _of_kind(hint: Any, value: Any) -> Any:
    """Return an entry; JSON has only the text of a named value, such as a finding's kind."""
    return hint(value) if isinstance(hint, type) and issubclass(hint, Enum) else value
