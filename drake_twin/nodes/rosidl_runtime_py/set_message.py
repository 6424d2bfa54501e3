"""Messages filled from dictionaries."""

import array
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from drake_twin.nodes.rosidl_runtime_py.utilities import get_message


def set_message_fields(
    msg: Any, values: dict[str, Any], expand_header_auto: bool = False, expand_time_now: bool = False
) -> list[Callable[[Any], None]]:
    """Set the fields of a message from a dictionary, whose values may be dictionaries and lists of them.

    Args:
        msg: The message.
        values: Field → value.
        expand_header_auto: Whether a header may be ``"auto"``.
        expand_time_now: Whether a time may be ``"now"``.

    Returns:
        Functions that set the times of such headers, and such times, to a ``builtin_interfaces.msg.Time``.

    Raises:
        AttributeError: If the message has no such field.
        TypeError: If a value does not fit its field.
    """
    if not hasattr(values, "items"):
        raise TypeError(f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}")
    stamps: list[Callable[[Any], None]] = []
    for name, value in values.items():
        field = getattr(msg, name)
        kind = msg.get_fields_and_field_types()[name]
        fill = partial(_filled, stamps=stamps, header=expand_header_auto, now=expand_time_now)
        if kind == "std_msgs/Header" and value == "auto" and expand_header_auto:
            stamps.append(partial(setattr, field, "stamp"))
        elif kind == "builtin_interfaces/Time" and value == "now" and expand_time_now:
            stamps.append(partial(setattr, msg, name))
        elif isinstance(field, array.array):
            setattr(msg, name, array.array(field.typecode, value))
        elif isinstance(field, np.ndarray):
            setattr(msg, name, np.array(value, dtype=field.dtype))
        elif isinstance(field, list):
            element = _element(kind)
            setattr(msg, name, [fill(get_message(element)(), each) for each in value] if element else list(value))
        elif hasattr(field, "get_fields_and_field_types"):
            setattr(msg, name, value if type(value) is type(field) else fill(type(field)(), value))
        else:
            setattr(msg, name, type(field)(value))
    return stamps


def _filled(message: Any, values: Any, *, stamps: list[Callable[[Any], None]], header: bool, now: bool) -> Any:
    if type(values) is type(message):
        return values
    stamps += set_message_fields(message, values, header, now)
    return message


def _element(kind: str) -> str:
    """Return the type of a sequence's messages; empty where it is one of numbers or strings."""
    name = kind.removeprefix("sequence<").partition("[")[0].partition(",")[0].rstrip(">")
    package, slash, own = name.partition("/")
    return f"{package}/msg/{own}" if slash else ""
