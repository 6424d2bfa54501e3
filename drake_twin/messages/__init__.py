"""Message types as in ROS 2 Jazzy: ``messages.JointState``, ``messages.TFMessage``, …

They are the dataclasses of rosbags' type store (NumPy arrays for numeric sequences), so a message goes to a bag or to a
wire as it is. The store is loaded at the first use of a type, because a twin without subscribers needs none. Types that
the store lacks are those of `drake_twin.messages.definitions`.
"""

import reprlib
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cache
from math import isfinite
from numbers import Real
from typing import Any

from drake_twin.frozen import Frozen
from drake_twin.messages.definitions import DEFINITIONS
from drake_twin.messages.interface_texts import interface_names
from drake_twin.saved import saved
from drake_twin.values import yaml_number

_DTYPES = {"char": "uint8"}  # NumPy's types that have another name in ROS

EMPTY = "structure_needs_at_least_one_member"  # the only field of a message without fields

# ROS's default values of fields, by type, where they are not false, zero or nothing: those of rosbags' store, which
# leaves them out; `interface_types` adds those of the types that it registers.
DEFAULTS: dict[str, dict[str, Any]] = {
    "geometry_msgs/msg/Quaternion": {"w": 1.0},
    "sensor_msgs/msg/NavSatStatus": {"status": -2},
}

_TYPES: dict[str, str] = {}  # the last part of a type's name → the type; filled when the store is loaded


@cache
def _jazzy() -> Any:
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    for name in (*store.types, *DEFINITIONS):
        _TYPES.setdefault(name.rpartition("/")[2], name)
    return store


@cache
def type_store() -> Any:
    """Return the rosbags ``Typestore`` of ROS 2 Jazzy with the types defined here added."""
    from rosbags.typesys import get_types_from_msg

    store = _jazzy()
    for name, text in DEFINITIONS.items():
        store.register(get_types_from_msg(text, name))
    return store


@cache
def base_packages() -> frozenset[str]:
    """Return the packages that rosbags' store has messages of."""
    from rosbags.typesys import Stores, get_typestore

    return frozenset(name.partition("/")[0] for name in get_typestore(Stores.ROS2_JAZZY).types)


@cache
def known_types() -> frozenset[str]:
    """Return the names of ROS 2 Jazzy's message types."""
    return frozenset((*_jazzy().types, *(name for name in interface_names() if "/msg/" in name)))


def _store_of(kind: str) -> Any:
    """Return a store that has a type; reading our definitions takes as long as a quarter of a robot, and is rare."""
    return type_store() if kind in DEFINITIONS else _jazzy()


def __getattr__(name: str) -> Any:
    if not name[0].isupper():  # a module's own attribute, for which the store is not loaded
        raise AttributeError(f"drake_twin.messages has no attribute {name!r}")
    _jazzy()
    if name not in _TYPES:
        raise AttributeError(f"drake_twin.messages has no message type {name!r}; it has {', '.join(sorted(_TYPES))}")
    message_type = _store_of(_TYPES[name]).types[_TYPES[name]]
    globals()[name] = message_type
    return message_type


def time_message(seconds: float) -> Any:
    """Return a simulation time (s) as a ``builtin_interfaces/msg/Time``, rounded to the nearest nanosecond."""
    sec, nanosec = divmod(round(seconds * 1e9), 1_000_000_000)  # here, too: it is made for each message
    return _message("Time")(sec, nanosec)


def duration_message(seconds: float) -> Any:
    """Return a time span (s) as a ``builtin_interfaces/msg/Duration``, rounded to the nearest nanosecond."""
    return _message("Duration")(**_sec_and_nanosec(seconds))


def _sec_and_nanosec(seconds: float) -> dict[str, int]:
    sec, nanosec = divmod(round(seconds * 1e9), 1_000_000_000)
    return {"sec": sec, "nanosec": nanosec}


def header(seconds: float, frame_id: str = "") -> Any:
    """Return a ``std_msgs/msg/Header`` stamped with a simulation time (s)."""
    return _message("Header")(stamp=time_message(seconds), frame_id=frame_id)


def imu_message(its_header: Any, values: Sequence[float], covariances: Sequence[Any]) -> Any:
    """Return a ``sensor_msgs/msg/Imu``.

    Args:
        its_header: Its header.
        values: Orientation (w, x, y, z), angular velocity (x, y, z; rad/s) and linear acceleration (x, y, z; m/s²).
        covariances: Of the three, each of shape (9,).
    """
    qw, qx, qy, qz, wx, wy, wz, ax, ay, az = values
    return _message("Imu")(
        header=its_header,
        orientation=_message("Quaternion")(x=qx, y=qy, z=qz, w=qw),
        orientation_covariance=covariances[0],
        angular_velocity=_message("Vector3")(x=wx, y=wy, z=wz),
        angular_velocity_covariance=covariances[1],
        linear_acceleration=_message("Vector3")(x=ax, y=ay, z=az),
        linear_acceleration_covariance=covariances[2],
    )


def message(kind: str, data: Any) -> Any:
    """Make a message of a type from plain data as ``ros2 topic pub`` takes it.

    Args:
        kind: The message type, for example ``geometry_msgs/msg/TwistStamped``.
        data: A message of that type; or a mapping of its fields, where missing ones have ROS's default values; or the
            bare numbers of a ``Float64MultiArray``. It is copied.

    Raises:
        ValueError: If the data does not fit the type; the text says where.
    """
    if kind == "std_msgs/msg/Float64MultiArray" and is_bare(data):
        return float64_multi_array(Numbers.read(data).data)
    return _from_plain(kind, data, "")


def is_bare(data: Any) -> bool:
    """Tell whether data is neither a message nor a mapping of a message's fields."""
    return not isinstance(data, Mapping) and not hasattr(data, "__msgtype__")


@saved("Numbers")
@dataclass(frozen=True)
class Numbers(Frozen):
    """All that a controller reads of a ``Float64MultiArray``, without the type store, which takes 50 ms to load."""

    data: tuple[float, ...]

    @classmethod
    def read(cls, data: Any) -> "Numbers":
        """Read bare numbers.

        Raises:
            ValueError: If the data is not a list of numbers; the text says where.
        """
        if data is None:
            raise ValueError("None is not a list")
        if type(data) in (list, tuple) and {*map(type, data)} <= {float}:
            return cls(tuple(data))
        items = data.tolist() if _is_vector(data) else [*_list(data, "data.")]
        if not {*map(type, items)} <= {float}:
            items = [_base("float64", item, f"data[{index}].") for index, item in enumerate(items)]
        return cls(tuple(items))


def _from_plain(kind: str, data: Any, path: str) -> Any:
    store = _store_of(kind)
    is_time = kind in ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")
    if is_time and isinstance(data, int | float) and not isinstance(data, bool):
        if not isfinite(data):
            raise ValueError(f"{path[:-1]}: {data!r} is not a time (s)")
        data = _sec_and_nanosec(data)
    _, fields = store.fielddefs[kind]
    names = [name for name, _ in fields if name != EMPTY]
    place = f"{path[:-1]}: " if path else ""
    message_type = getattr(data, "__msgtype__", None)
    if message_type is not None:
        if message_type != kind:
            raise ValueError(f"{place}this is a {message_type}, but a {kind} is needed")
        data = {name: getattr(data, name, None) for name in names}
    if not isinstance(data, Mapping):
        raise ValueError(f"{place}{shortened(data)} is not a mapping of the fields of a {kind}")
    for name in data:
        if name not in names:
            raise ValueError(f"a {kind} has no field {path}{name!s}; it has {', '.join(names) or 'none'}")
    defaults = DEFAULTS.get(kind, {})
    values = {name: defaults.get(name) if data.get(name) is None else data[name] for name, _ in fields}
    return store.types[kind](
        **{name: field_value(description, values[name], f"{path}{name}.") for name, description in fields}
    )


def field_value(description: Any, value: Any, path: str) -> Any:
    """Make a field's value from plain data.

    Args:
        description: The field's type: rosbags' (node type, details).
        value: The data; None for zero or nothing.
        path: The field's name with a dot behind it, for the error.

    Raises:
        ValueError: If the data does not fit the type; the text says where.
    """
    import numpy as np
    from rosbags.interfaces import Nodetype

    node, details = description
    if node == Nodetype.NAME:
        return _from_plain(details, {} if value is None else value, path)
    if node == Nodetype.BASE:
        kind = details[0]
        if value is None:
            return {"string": "", "wstring": "", "bool": False}.get(kind, 0.0 if "float" in kind else 0)
        return _base(kind, value, path)
    element, size = details
    values = [] if value is None else _list(value, path)
    if value is None and node == Nodetype.ARRAY:
        values = [None] * size
    kind = element[1][0] if element[0] == Nodetype.BASE else ""
    if _is_vector(values) and "float" in kind:
        items: Any = values
    else:
        items = [field_value(element, item, f"{path[:-1]}[{index}].") for index, item in enumerate(values)]
    if node == Nodetype.ARRAY and len(items) != size:
        raise ValueError(f"{path[:-1]}: {len(items)} elements, but {size} are needed")
    return np.array(items, dtype=_DTYPES.get(kind, kind)) if kind not in ("", "string", "wstring") else items


def _is_vector(value: Any) -> bool:
    """Tell whether a value is a one-dimensional NumPy array of floating-point numbers."""
    import numpy as np

    return isinstance(value, np.ndarray) and value.dtype.kind == "f" and value.ndim == 1


def _list(value: Any, path: str) -> Any:
    if isinstance(value, str | bytes | Mapping | Set) or not hasattr(value, "__iter__"):
        raise ValueError(f"{path[:-1]}: {shortened(value)} is not a list")
    return value


def _base(kind: str, value: Any, path: str) -> Any:
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
        integer, limits = int(whole), np.iinfo(_DTYPES.get(kind, kind))
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


def float64_multi_array(values: Any) -> Any:
    """Return numbers as a ``std_msgs/msg/Float64MultiArray`` without layout, as controllers are commanded."""
    import numpy as np

    layout = _message("MultiArrayLayout")(dim=[], data_offset=0)
    return _message("Float64MultiArray")(layout=layout, data=np.array(values, dtype=float))


@cache
def _message(name: str) -> Any:
    return __getattr__(name)
