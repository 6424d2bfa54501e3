"""The values of messages' fields, from plain data."""

import reprlib
from collections.abc import Callable, Mapping, Set
from numbers import Real
from typing import Any

from drake_twin.values import yaml_number


def field_value(description: Any, value: Any, path: str, message: Callable[[str, Any, str], Any] | None = None) -> Any:
    """Make a field's value from plain data.

    Args:
        description: The field's type: rosbags' (node type, details).
        value: The data; None for zero or nothing.
        path: The field's name with a dot behind it, for the error.
        message: Makes the message of a type, data and a path; needed by fields that are messages.

    Raises:
        ValueError: If the data does not fit the type; the text says where.
    """
    import numpy as np
    from rosbags.interfaces import Nodetype

    node, details = description
    if node == Nodetype.NAME and message is not None:
        return message(details, {} if value is None else value, path)
    if node == Nodetype.BASE:
        kind = details[0]
        if value is None:
            return {"string": "", "wstring": "", "bool": False}.get(kind, 0.0 if "float" in kind else 0)
        return base_value(kind, value, path)
    element, size = details
    values = [] if value is None else list_of(value, path)
    if value is None and node == Nodetype.ARRAY:
        values = [None] * size
    kind = element[1][0] if element[0] == Nodetype.BASE else ""
    if (is_vector(values) and "float" in kind) or _fits(values, kind):
        items: Any = values
    else:
        items = [field_value(element, item, f"{path[:-1]}[{index}].", message) for index, item in enumerate(values)]
    if node == Nodetype.ARRAY and len(items) != size:
        raise ValueError(f"{path[:-1]}: {len(items)} elements, but {size} are needed")
    return np.array(items, dtype=kind) if kind not in ("", "string", "wstring") else items


def is_vector(value: Any) -> bool:
    """Tell whether a value is a one-dimensional NumPy array of floating-point numbers."""
    import numpy as np

    return isinstance(value, np.ndarray) and value.dtype.kind == "f" and value.ndim == 1


def _fits(value: Any, kind: str) -> bool:
    """Tell whether a value is a one-dimensional NumPy array of whole numbers that a type of ROS has all."""
    import numpy as np

    is_whole = isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind in "iu"
    return is_whole and "int" in kind and np.can_cast(value.dtype, kind)


def list_of(value: Any, path: str) -> Any:
    """Return a value that can be iterated over.

    Raises:
        ValueError: If it is not a list; the text says where.
    """
    if isinstance(value, str | bytes | Mapping | Set) or not hasattr(value, "__iter__"):
        raise ValueError(f"{path[:-1]}: {shortened(value)} is not a list")
    return value


def base_value(kind: str, value: Any, path: str) -> Any:
    """Return a number, flag or text as a type of ROS, for example ``uint8``, has it.

    Raises:
        ValueError: If it does not fit the type; the text says where.
    """
    import numpy as np

    try:
        if kind in ("string", "wstring"):
            if not isinstance(value, str):
                raise TypeError
            return value
        if kind == "bool":
            if not isinstance(value, bool | np.bool_):
                raise TypeError
            return bool(value)
        if "float" in kind:
            number = yaml_number(value)
            if number is None:
                raise TypeError
            return number
        if isinstance(value, bool) or not isinstance(value, Real) or not float(value).is_integer():
            raise TypeError
        whole: Any = value
        integer, limits = int(whole), np.iinfo(kind)
        if kind == "byte" and limits.max < integer < 256:
            return integer - 256  # rosbags has the bytes of ROS as numbers with a sign
        if not limits.min <= integer <= limits.max:
            raise ValueError
        return integer
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{path[:-1]}: {shortened(value)} is not a {kind}") from None


def shortened(value: Any) -> str:
    """Return a value as an error message shows it: a list of a million numbers by its first ones."""
    return reprlib.repr(value)
