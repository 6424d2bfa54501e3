"""Parameters as ROS has them: their names with dots, and values of ``rcl_interfaces/msg/ParameterValue``."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

NOT_SET = 0  # rcl_interfaces/msg/ParameterType
_TYPES = {bool: 1, int: 2, float: 3, str: 4}
_ARRAY_TYPES = {bool: 6, int: 7, float: 8, str: 9}
FIELDS = {  # type → the field with its value
    1: "bool_value",
    2: "integer_value",
    3: "double_value",
    4: "string_value",
    5: "byte_array_value",
    6: "bool_array_value",
    7: "integer_array_value",
    8: "double_array_value",
    9: "string_array_value",
}


def flat(parameters: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield parameters by their names in ROS: those in a nested mapping have the names above, with dots."""
    for name, value in parameters.items() if isinstance(parameters, Mapping) else ():
        if isinstance(value, Mapping):
            yield from flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def type_of(value: Any) -> int:
    """Return a value's ``ParameterType``; `NOT_SET` for what ROS has no type for."""
    if isinstance(value, bytes):
        return 5
    if isinstance(value, Sequence) and not isinstance(value, str):
        kinds = {type(item) for item in value}
        kind = float if kinds == {int, float} else kinds.pop() if len(kinds) == 1 else None
        return _ARRAY_TYPES.get(kind, NOT_SET) if kind is not None else NOT_SET
    return _TYPES.get(type(value), NOT_SET)


def value_fields(value: Any) -> Mapping[str, Any]:
    """Return the fields of a ``ParameterValue``; of type 0 for what ROS has no type for."""
    kind = type_of(value)
    if kind == NOT_SET:
        return {"type": kind}
    return {"type": kind, FIELDS[kind]: list(value) if kind == 5 else value}


def python_value(message: Any) -> Any:
    """Return what a ``ParameterValue`` holds: a list for an array, bytes for bytes, None where nothing is set."""
    if message.type not in FIELDS:
        return None
    value = getattr(message, FIELDS[message.type])
    value = value.tolist() if hasattr(value, "tolist") else value
    return bytes(item % 256 for item in value) if message.type == 5 else value
