"""Message types as in ROS 2 Jazzy: ``messages.JointState``, ``messages.TFMessage``, …

They are the dataclasses of rosbags' type store (NumPy arrays for numeric sequences), so a message goes to a bag or to a
wire as it is. The store is loaded at the first use of a type, because a twin without subscribers needs none. Types of
other packages than the store's are loaded into it one by one.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from math import isfinite
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.frozen import Frozen
from drake_twin.messages.field_values import base_value, field_value, is_vector, list_of
from drake_twin.messages.field_values import shortened as shortened
from drake_twin.messages.interface_texts import interface_names
from drake_twin.messages.store import DEFAULTS, OF_THE_TWIN, base_types, store_with
from drake_twin.messages.store import EMPTY as EMPTY
from drake_twin.messages.store import type_store as type_store
from drake_twin.saved import saved

_PARTS = ("_Goal", "_Result", "_Feedback")


@cache
def known_types() -> frozenset[str]:
    """Return the names of ROS 2 Jazzy's message types."""
    return base_types() | {name for name in interface_names() if "/msg/" in name}


@cache
def _base_names() -> dict[str, str]:
    """Return the types of rosbags' store by the last part of their names."""
    return {name.rpartition("/")[2]: name for name in sorted(base_types(), reverse=True)}


@cache
def _other_names() -> dict[str, str]:
    """Return the other types that the twin may use, by the last part of their names."""
    its = sorted(name for name in interface_names() if name.partition("/")[0] in OF_THE_TWIN)
    names = [name for name in its if "/msg/" in name]
    names += [f"{name}{part}" for name in its if "/action/" in name for part in _PARTS]
    return {name.rpartition("/")[2]: name for name in reversed(names)}


def __getattr__(name: str) -> Any:
    if not name[0].isupper():  # a module's own attribute, for which the store is not loaded
        raise AttributeError(f"drake_twin.messages has no attribute {name!r}")
    kind = _base_names().get(name) or _other_names().get(name)
    if kind is None:
        known = ", ".join(sorted({*_base_names(), *_other_names()}))
        raise AttributeError(f"drake_twin.messages has no message type {name!r}; it has {known}")
    found = globals()[name] = store_with(kind).types[kind]
    return found


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
        items = data.tolist() if is_vector(data) else [*list_of(data, "data.")]
        if not {*map(type, items)} <= {float}:
            items = [base_value("float64", item, f"data[{index}].") for index, item in enumerate(items)]
        return cls(tuple(items))


def _from_plain(kind: str, data: Any, path: str) -> Any:
    store = store_with(kind)
    is_time = kind in ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")
    if is_time and isinstance(data, int | float) and not isinstance(data, bool):
        if not isfinite(data):
            raise ValueError(f"{path[:-1]}: {data!r} is not a time (s)")
        data = _sec_and_nanosec(data)
    _, fields = store.fielddefs[kind]
    names = [name for name, _ in fields if name != EMPTY]
    place = f"{path[:-1]}: " if path else ""
    its_type = getattr(data, "__msgtype__", None)
    if its_type is not None:
        if its_type != kind:
            raise ValueError(f"{place}this is a {its_type}, but a {kind} is needed")
        data = {name: getattr(data, name, None) for name in names}
    if not isinstance(data, Mapping):
        raise ValueError(f"{place}{shortened(data)} is not a mapping of the fields of a {kind}")
    for name in data:
        if name not in names:
            raise ValueError(f"a {kind} has no field {path}{name!s}; it has {', '.join(names) or 'none'}")
    defaults = DEFAULTS.get(kind, {})
    values = {name: defaults.get(name) if data.get(name) is None else data[name] for name, _ in fields}
    return store.types[kind](
        **{name: field_value(description, values[name], f"{path}{name}.", _from_plain) for name, description in fields}
    )


def float64_multi_array(values: Any) -> Any:
    """Return numbers as a ``std_msgs/msg/Float64MultiArray`` without layout, as controllers are commanded."""
    import numpy as np

    layout = _message("MultiArrayLayout")(dim=[], data_offset=0)
    return _message("Float64MultiArray")(layout=layout, data=np.array(values, dtype=float))


@cache
def _message(name: str) -> Any:
    return __getattr__(name)
