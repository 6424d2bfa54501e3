"""Stand-in for ``rosidl_runtime_py.set_message``: the fields of messages from plain data."""

import array
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from drake_twin.nodes.message_classes import message_class


def set_message_fields(
    msg: Any, values: dict[str, Any], expand_header_auto: bool = False, expand_time_now: bool = False
) -> list[Any]:
    """Set fields of a message.

    Args:
        msg: The message.
        values: Their values by their names.
        expand_header_auto: Whether ``auto`` stands for a header with the present time.
        expand_time_now: Whether ``now`` stands for the present time.

    Returns:
        Functions that set the fields with the present time, once they are given it.

    Raises:
        AttributeError: If the message has not such a field.
        TypeError: If a value does not fit its field.
    """
    later: list[Any] = []
    _fill(msg, values, expand_header_auto, expand_time_now, later)
    return later


def _fill(msg: Any, values: Any, expand_header: bool, expand_now: bool, later: list[Any]) -> None:
    if not isinstance(values, Mapping):
        kind = type(values).__name__
        raise TypeError(f"Value '{values}' is expected to be a dictionary but is a {kind}")
    for name, given in values.items():
        field = getattr(msg, name)
        kind = getattr(type(field), "__ros_type__", "")
        if kind == "std_msgs/msg/Header" and given == "auto" and expand_header:
            later.append(partial(setattr, field, "stamp"))
            continue
        if kind == "builtin_interfaces/msg/Time" and given == "now" and expand_now:
            later.append(partial(setattr, msg, name))
            continue
        if isinstance(field, array.array):
            value: Any = array.array(field.typecode, given)
        elif isinstance(field, np.ndarray):
            value = np.array(given, dtype=field.dtype)
        elif type(given) is type(field):
            value = given
        elif kind:
            value = type(field)()
            _fill(value, given, expand_header, expand_now, later)
        else:
            value = type(field)(given)
        inner = msg.get_fields_and_field_types()[name].removeprefix("sequence<").partition(">")[0]
        inner = inner.partition("[")[0].partition(",")[0]
        if "/" in inner and isinstance(value, list):
            package, _, own = inner.partition("/")
            for index, item in enumerate(value):
                value[index] = message_class(f"{package}/msg/{own}")()
                _fill(value[index], item, expand_header, expand_now, later)
        setattr(msg, name, value)
