"""Messages of gz's transport as the ROS messages that ros_gz's bridge makes of them: their types, fields and values."""

from collections.abc import Iterator, Mapping
from dataclasses import field
from math import inf
from struct import pack, unpack
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.description.protobuf_text import Fields, Word, read_fields, read_value
from drake_twin.errors import did_you_mean
from drake_twin.values import is_number

FLOAT, SINGLE, INTEGER, BOOLEAN, TEXT = "number", "number of 4 bytes", "whole number", "true or false", "text"
_NUMBERS = (FLOAT, SINGLE)
_DEFAULTS: dict[str, Any] = {FLOAT: 0.0, SINGLE: 0.0, INTEGER: 0, BOOLEAN: False, TEXT: ""}
_LISTED = "[]"
_PREFIXES = ("gz.msgs.", "ignition.msgs.", "gz_msgs.", "ign_msgs.")


class UnknownMessageError(Exception):
    """Raised for a type or a field that the twin does not know; the message says which."""


@dataclass(frozen=True)
class GzType:
    """A type of messages.

    Attributes:
        ros: The ROS type.
        fields: Field → its field in ROS, with points between nested ones, and its kind: one of `FLOAT`, `SINGLE`,
            `INTEGER`, `BOOLEAN`, `TEXT`, or another of these types; with ``[]`` for a field that is repeated.
    """

    ros: str
    fields: Mapping[str, tuple[str, str]] = field(default_factory=dict)


def _same(**kinds: str) -> dict[str, tuple[str, str]]:
    return {name: (name, kind) for name, kind in kinds.items()}


# Headers are left out: what the twin publishes has its own, and those of messages are not compared.
GZ_TYPES: dict[str, GzType] = {
    "Empty": GzType("std_msgs/msg/Empty"),
    "Boolean": GzType("std_msgs/msg/Bool", _same(data=BOOLEAN)),
    "Double": GzType("std_msgs/msg/Float64", _same(data=FLOAT)),
    "Float": GzType("std_msgs/msg/Float32", _same(data=SINGLE)),
    "Int32": GzType("std_msgs/msg/Int32", _same(data=INTEGER)),
    "UInt32": GzType("std_msgs/msg/UInt32", _same(data=INTEGER)),
    "StringMsg": GzType("std_msgs/msg/String", _same(data=TEXT)),
    "StringMsg_V": GzType("ros_gz_interfaces/msg/StringVec", _same(data=TEXT + _LISTED)),
    "Float_V": GzType("ros_gz_interfaces/msg/Float32Array", _same(data=SINGLE + _LISTED)),
    "Time": GzType("builtin_interfaces/msg/Time", {"sec": ("sec", INTEGER), "nsec": ("nanosec", INTEGER)}),
    "Clock": GzType("rosgraph_msgs/msg/Clock", {"sim": ("clock", "Time")}),
    "Vector3d": GzType("geometry_msgs/msg/Vector3", _same(x=FLOAT, y=FLOAT, z=FLOAT)),
    "Quaternion": GzType("geometry_msgs/msg/Quaternion", _same(x=FLOAT, y=FLOAT, z=FLOAT, w=FLOAT)),
    "Pose": GzType("geometry_msgs/msg/Pose", _same(position="Vector3d", orientation="Quaternion")),
    "Twist": GzType("geometry_msgs/msg/Twist", _same(linear="Vector3d", angular="Vector3d")),
    "Wrench": GzType("geometry_msgs/msg/Wrench", _same(force="Vector3d", torque="Vector3d")),
    "Odometry": GzType("nav_msgs/msg/Odometry", {"pose": ("pose.pose", "Pose"), "twist": ("twist.twist", "Twist")}),
    "Actuators": GzType(
        "actuator_msgs/msg/Actuators",
        _same(position=FLOAT + _LISTED, velocity=FLOAT + _LISTED, normalized=FLOAT + _LISTED),
    ),
    "Altimeter": GzType(
        "ros_gz_interfaces/msg/Altimeter",
        _same(vertical_position=FLOAT, vertical_velocity=FLOAT, vertical_reference=FLOAT),
    ),
    "IMU": GzType(
        "sensor_msgs/msg/Imu",
        _same(orientation="Quaternion", angular_velocity="Vector3d", linear_acceleration="Vector3d"),
    ),
    "FluidPressure": GzType(
        "sensor_msgs/msg/FluidPressure", {"pressure": ("fluid_pressure", FLOAT), "variance": ("variance", FLOAT)}
    ),
    "BatteryState": GzType(
        "sensor_msgs/msg/BatteryState",
        _same(voltage=FLOAT, current=FLOAT, charge=FLOAT, capacity=FLOAT, percentage=FLOAT),
    ),
    "Contacts": GzType("ros_gz_interfaces/msg/Contacts"),
    "LaserScan": GzType("sensor_msgs/msg/LaserScan"),
    "Image": GzType("sensor_msgs/msg/Image"),
}


# What a gz.msgs.Pose has and ROS's one has not: of the twin's own messages, those of a PerformerDetector have them.
_NAME, _HEADER_DATA = "name", "header.data"


@dataclass(frozen=True)
class Leaf:
    """A field that is compared.

    Attributes:
        path: Its place in the ROS message.
        value: Its value: a number, a flag, a text, or a tuple of such.
        has_tolerance: Whether it is a number with a point.
        is_in: Whether a repeated field only has to have the values in it.
        is_single: Whether it is a number of 4 bytes.
    """

    path: tuple[str, ...]
    value: Any
    has_tolerance: bool = False
    is_in: bool = False
    is_single: bool = False

    def fits(self, message: Any, tolerance: float) -> bool:
        """Tell whether a ROS message has the value there; one without the field does not."""
        for name in self.path:
            message = getattr(message, name, None)
        if message is None:
            return False
        if not isinstance(self.value, tuple):
            return self._equal(self.value, message, tolerance)
        found = list(message)
        if self.is_in:
            return all(any(self._equal(value, other, tolerance) for other in found) for value in self.value)
        pairs = zip(self.value, found, strict=False)
        return len(found) == len(self.value) and all(self._equal(value, other, tolerance) for value, other in pairs)

    def _equal(self, value: Any, other: Any, tolerance: float) -> bool:
        if self.is_single:
            other = _single(other)
        return bool(value == other or (self.has_tolerance and abs(value - other) <= tolerance))


def gz_type(name: str) -> str:
    """Return a type's name without its package.

    Raises:
        UnknownMessageError: If the twin does not know it.
    """
    own = next((name.removeprefix(prefix) for prefix in _PREFIXES if name.startswith(prefix)), name)
    if own not in GZ_TYPES:
        raise UnknownMessageError(f"the twin knows no message type {name!r}{did_you_mean(own, GZ_TYPES)}")
    return own


def ros_fields(kind: str, text: str) -> dict[str, Any]:
    """Return a message's text as the fields of the ROS message.

    Args:
        kind: The type, as `gz_type` returns it.
        text: The message in the text format of Protocol Buffers.

    Raises:
        ValueError: If the text is not a message of the type.
        UnknownMessageError: If it has a field that the twin does not know.
    """
    message: dict[str, Any] = {}
    for leaf in _leaves(kind, read_fields(text), (), given_only=True):
        inside = message
        for name in leaf.path[:-1]:
            inside = inside.setdefault(name, {})
        inside[leaf.path[-1]] = list(leaf.value) if isinstance(leaf.value, tuple) else leaf.value
    return message


def message_leaves(kind: str, text: str) -> tuple[Leaf, ...]:
    """Return what a whole message has to have in each field, as `ros_fields` reads it; what is not given is zero."""
    return tuple(_leaves(kind, read_fields(text), (), given_only=False))


def field_leaves(kind: str, name: str, text: str) -> tuple[Leaf, ...]:
    """Return what a field of a message has to have.

    Args:
        kind: The message's type.
        name: The field, with points between nested ones.
        text: Its value; of a repeated field one of its values.

    Raises:
        ValueError: If the text is not a value of the field.
        UnknownMessageError: If the type has no such field that the twin knows.
    """
    if kind == "Pose" and name in (_NAME, _HEADER_DATA):
        return _of_pose(name, text)
    path: tuple[str, ...] = ()
    *above, last = name.split(".")
    for each in above:
        path, kind = _inside(kind, each, path)
        if kind not in GZ_TYPES:
            raise UnknownMessageError(f"{each!r} of the field {name!r} has no fields")
    path, found = _inside(kind, last, path)
    value = read_value(text)
    if found.endswith(_LISTED):
        of_list = found.removesuffix(_LISTED)
        return (
            Leaf(path, (_scalar(of_list, value, last),), of_list in _NUMBERS, is_in=True, is_single=of_list == SINGLE),
        )
    if found in _DEFAULTS:
        return (Leaf(path, _scalar(found, value, last), found in _NUMBERS, is_single=found == SINGLE),)
    if not isinstance(value, dict):
        raise ValueError(f"{last!r} is {value!r}, which is not a message in braces")
    return tuple(_leaves(found, value, path, given_only=False))


def _of_pose(name: str, text: str) -> tuple[Leaf, ...]:
    value = read_value(text)
    if name == _NAME:
        return (Leaf((name,), _scalar(TEXT, value, name)),)
    if not isinstance(value, dict) or not {*value} <= {"key", "value"}:
        raise ValueError(f"{name!r} is {text!r}, which is not a key and a value in braces")
    key, *others = [_scalar(TEXT, item, "key") for item in value.get("key", [""])]
    if others:
        raise ValueError(f"the field 'key' is given {1 + len(others)} times")
    values = tuple(_scalar(TEXT, item, "value") for item in value.get("value", ()))
    return (Leaf(tuple(name.split(".")), ((key, values),), is_in=True),)


def _inside(kind: str, name: str, path: tuple[str, ...]) -> tuple[tuple[str, ...], str]:
    """Return the place of a field in the ROS message, and its kind."""
    fields = GZ_TYPES[kind].fields
    if name not in fields:
        raise UnknownMessageError(f"the twin knows no field {name!r} of gz.msgs.{kind}{did_you_mean(name, fields)}")
    ros, found = fields[name]
    return (*path, *ros.split(".")), found


def _leaves(kind: str, given: Fields, path: tuple[str, ...], *, given_only: bool) -> Iterator[Leaf]:
    for name in given:
        _inside(kind, name, path)
    for name in GZ_TYPES[kind].fields:
        own, found = _inside(kind, name, path)
        values = given.get(name, [])
        if given_only and not values:
            continue
        if found.endswith(_LISTED):
            of_list = found.removesuffix(_LISTED)
            every = tuple(_scalar(of_list, value, name) for value in values)
            yield Leaf(own, every, of_list in _NUMBERS, is_single=of_list == SINGLE)
            continue
        if len(values) > 1:
            raise ValueError(f"the field {name!r} is given {len(values)} times")
        if found in _DEFAULTS:
            value = _scalar(found, values[0], name) if values else _DEFAULTS[found]
            yield Leaf(own, value, found in _NUMBERS, is_single=found == SINGLE)
            continue
        inside = values[0] if values else {}
        if not isinstance(inside, dict):
            raise ValueError(f"{name!r} is {inside!r}, which is not a message in braces")
        yield from _leaves(found, inside, own, given_only=given_only)


def _scalar(kind: str, value: Any, name: str) -> Any:
    """Return a value of a field as one of its kind."""
    if kind in _NUMBERS and isinstance(value, float | int):
        return float(value) if kind == FLOAT else _single(float(value))
    if kind == INTEGER and isinstance(value, int) and -(2**31) <= value < 2**32:
        return value
    if kind == BOOLEAN and (value in ("true", "True", "t", "false", "False", "f") or value in (0, 1)):
        return value in ("true", "True", "t") or (is_number(value) and value == 1)
    if kind == TEXT and isinstance(value, str) and not isinstance(value, Word):
        return value
    raise ValueError(f"{name!r} is {value!r}, which is not a {kind}")


def _single(value: float) -> float:
    """Round a number as a message with 4 bytes for it does."""
    try:
        return float(unpack("f", pack("f", value))[0])
    except OverflowError:
        return inf if value > 0.0 else -inf
