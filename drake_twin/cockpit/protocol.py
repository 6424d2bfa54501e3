"""What a browser may ask for, as plain data; whatever does not read as one of these is nothing."""

import json
import types
import typing
from dataclasses import dataclass, fields
from functools import cache
from math import isfinite
from typing import Any

from drake_twin.description.robot_description import Vector3

_LONGEST_TEXT = 1000
_MOST_STEPS = 10_000


@dataclass(frozen=True)
class Play:
    """Let time go on."""


@dataclass(frozen=True)
class Pause:
    """Stop time."""


@dataclass(frozen=True)
class Step:
    """Make so many physics steps and stay paused."""

    count: int


@dataclass(frozen=True)
class RunTo:
    """Go on until a simulation time (s), and pause there."""

    time: float


@dataclass(frozen=True)
class Reset:
    """Go back to the start."""


@dataclass(frozen=True)
class SetRate:
    """Simulated seconds a second."""

    rate: float


@dataclass(frozen=True)
class SetTimeStep:
    """The physics step (s)."""

    seconds: float


@dataclass(frozen=True)
class Switch:
    """Activate or deactivate a controller."""

    robot: str
    controller: str
    active: bool


@dataclass(frozen=True)
class MoveJoint:
    """Command one element of a topic (rad, rad/s, N·m, or m, m/s, N) and leave the others as they are."""

    topic: str
    index: int
    value: float


@dataclass(frozen=True)
class PoseJoint:
    """Put a joint of a robot that is only displayed somewhere (rad or m)."""

    robot: str
    joint: str
    position: float


@dataclass(frozen=True)
class Drive:
    """Velocities for a base (m/s, m/s, rad/s); they hold as long as this is sent again and again."""

    topic: str
    x: float
    y: float
    turn: float


@dataclass(frozen=True)
class EmergencyStop:
    """Stop a robot and hold it."""

    robot: str


@dataclass(frozen=True)
class ClearEmergencyStop:
    """Let a robot's controllers command again."""

    robot: str


@dataclass(frozen=True)
class Show:
    """Draw something besides the robots, or not."""

    what: str
    on: bool


@dataclass(frozen=True)
class Follow:
    """Let the camera go along with a robot; with none when the name is empty."""

    robot: str


@dataclass(frozen=True)
class Record:
    """Record for a page that plays back offline, or end the recording and offer it."""

    on: bool


@dataclass(frozen=True)
class Spawn:
    """Add a robot: its file's address, its name, where it stands (m, rad)."""

    file: str
    name: str
    xyz: Vector3
    rpy: Vector3


@dataclass(frozen=True)
class Delete:
    """Take a robot away."""

    robot: str


@dataclass(frozen=True)
class Gone:
    """A browser's connection has ended; said by the server, never by a browser."""


Request = (
    Play
    | Pause
    | Step
    | RunTo
    | Reset
    | SetRate
    | SetTimeStep
    | Switch
    | MoveJoint
    | PoseJoint
    | Drive
    | EmergencyStop
    | ClearEmergencyStop
    | Show
    | Follow
    | Record
    | Spawn
    | Delete
    | Gone
)

_KINDS: dict[str, Any] = {kind.__name__: kind for kind in typing.get_args(Request) if kind is not Gone}


def parse(text: str) -> Request | None:
    """A browser's message, ``{"do": "MoveJoint", "topic": …}``, as a request.

    Returns:
        None for anything else: no JSON, an unknown request, a field missing, too many or of the wrong type, a number
        that is not finite.
    """
    try:
        data = json.loads(text)
    except (ValueError, RecursionError):
        return None
    if not isinstance(data, dict):
        return None
    kind = data.pop("do", None)
    if not isinstance(kind, str) or kind not in _KINDS:
        return None
    field_types = _field_types(_KINDS[kind])
    if data.keys() != field_types.keys():
        return None
    values = {name: _value(field_types[name], value) for name, value in data.items()}
    if None in values.values():
        return None
    request: Request = _KINDS[kind](**values)
    if isinstance(request, Step) and not 1 <= request.count <= _MOST_STEPS:
        return None
    return request


@cache
def _field_types(kind: Any) -> dict[str, Any]:
    hints = typing.get_type_hints(kind)
    return {item.name: hints[item.name] for item in fields(kind)}


def _value(kind: Any, value: Any) -> Any:
    """A value of an annotated type; None if it is none."""
    if isinstance(kind, types.GenericAlias):
        if not isinstance(value, list) or len(value) != len(typing.get_args(kind)):
            return None
        items = tuple(_value(float, item) for item in value)
        return None if None in items else items
    if kind is bool:
        return value if isinstance(value, bool) else None
    if kind is str:
        return value if isinstance(value, str) and len(value) <= _LONGEST_TEXT and value.isprintable() else None
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    if kind is int:
        return value if isinstance(value, int) and abs(value) < 2**31 else None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if isfinite(number) else None
