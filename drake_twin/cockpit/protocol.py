"""The requests that a browser may send; any other message is ignored."""

import json
import types
import typing
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from math import isfinite
from typing import Any

_LONGEST_TEXT = 1000
_LONGEST_LINES = 20_000

Lines = typing.NewType("Lines", str)  # a text of several lines
_MOST_STEPS = 10_000


@dataclass(frozen=True)
class Play:
    """Continue simulation time."""


@dataclass(frozen=True)
class Pause:
    """Pause simulation time."""


@dataclass(frozen=True)
class Step:
    """Make a number of physics steps and stay paused."""

    count: int


@dataclass(frozen=True)
class RunTo:
    """Run until a simulation time (s) and pause there."""

    time: float


@dataclass(frozen=True)
class Reset:
    """Reset the twin."""


@dataclass(frozen=True)
class Look:
    """Pause, and draw again what was drawn at a simulation time (s)."""

    time: float


@dataclass(frozen=True)
class LookAtNow:
    """Draw the present again."""


@dataclass(frozen=True)
class GoOnFrom:
    """Return to the last moment that is kept before a simulation time (s), and continue from there."""

    time: float


@dataclass(frozen=True)
class SetRate:
    """Set the real-time rate: simulated seconds per second of wall time."""

    rate: float


@dataclass(frozen=True)
class SetTimeStep:
    """Set the physics step (s)."""

    seconds: float


@dataclass(frozen=True)
class Switch:
    """Activate or deactivate a controller."""

    robot: str
    controller: str
    active: bool


@dataclass(frozen=True)
class SwitchTo:
    """Activate a controller, and deactivate those that command the same joints."""

    robot: str
    controller: str


@dataclass(frozen=True)
class MoveJoint:
    """Command one element of a topic (rad, rad/s, N·m, or m, m/s, N) and keep the others."""

    topic: str
    index: int
    value: float


@dataclass(frozen=True)
class PoseJoint:
    """Set the joint position of a robot that is only displayed (rad or m)."""

    robot: str
    joint: str
    position: float


@dataclass(frozen=True)
class Drive:
    """Drive a base with velocities (m/s, m/s, rad/s), which hold while the request is repeated."""

    topic: str
    x: float
    y: float
    turn: float


@dataclass(frozen=True)
class EmergencyStop:
    """Stop a robot and hold it there."""

    robot: str


@dataclass(frozen=True)
class ClearEmergencyStop:
    """Clear a robot's emergency stop."""

    robot: str


@dataclass(frozen=True)
class Show:
    """Show or hide an overlay."""

    what: str
    on: bool


@dataclass(frozen=True)
class ShowSensor:
    """Show what a sensor measures, or no more: its key in the page's list."""

    sensor: str
    on: bool


@dataclass(frozen=True)
class LookAtEfforts:
    """A tab shows efforts, for which the plant solves a step; repeated about once a second."""


@dataclass(frozen=True)
class Follow:
    """Let the camera follow a robot, or no robot if the name is empty."""

    robot: str


@dataclass(frozen=True)
class Record:
    """Start a recording as an HTML page, or end it and offer the page for download."""

    on: bool


@dataclass(frozen=True)
class Delete:
    """Delete a robot."""

    robot: str


@dataclass(frozen=True)
class AskPanel:
    """Ask the Python half of a panel: JSON data for its ``ask``."""

    panel: str
    data: Lines


@dataclass(frozen=True)
class Gone:
    """A browser's connection has ended; the server adds this request, a browser cannot send it."""


Request = (
    Play
    | Pause
    | Step
    | RunTo
    | Reset
    | Look
    | LookAtNow
    | GoOnFrom
    | SetRate
    | SetTimeStep
    | Switch
    | SwitchTo
    | MoveJoint
    | PoseJoint
    | Drive
    | EmergencyStop
    | ClearEmergencyStop
    | Show
    | ShowSensor
    | LookAtEfforts
    | Follow
    | Record
    | Delete
    | AskPanel
    | Gone
)

_KINDS: dict[str, Any] = {kind.__name__: kind for kind in typing.get_args(Request) if kind is not Gone}


def parse(text: str) -> Request | None:
    """Parse a browser's message, such as ``{"do": "MoveJoint", "topic": …}``.

    Returns:
        The request; None if the message is not JSON, the request is unknown, a field is missing, unknown or of the
        wrong type, or a number is not finite.
    """
    try:
        data = json.loads(text)
    except (ValueError, RecursionError):
        return None
    if not isinstance(data, dict):
        return None
    request: Request | None = read_as(_KINDS, data)
    if isinstance(request, Step) and not 1 <= request.count <= _MOST_STEPS:
        return None
    return request


def read_as(kinds: Mapping[str, Any], data: Mapping[str, Any]) -> Any:
    """Return plain data, such as ``{"do": "Step", "count": 1}``, as the dataclass that ``do`` names.

    Args:
        kinds: Name → dataclass.
        data: The data.

    Returns:
        None if the name is unknown, a field is missing, unknown or of the wrong type, or a number is not finite.
    """
    kind = data.get("do")
    if not isinstance(kind, str) or kind not in kinds:
        return None
    given = {name: value for name, value in data.items() if name != "do"}
    field_types = _field_types(kinds[kind])
    if given.keys() != field_types.keys():
        return None
    values = {name: _value(field_types[name], value) for name, value in given.items()}
    return None if None in values.values() else kinds[kind](**values)


@cache
def _field_types(kind: Any) -> dict[str, Any]:
    hints = typing.get_type_hints(kind)
    return {item.name: hints[item.name] for item in fields(kind)}


def _value(kind: Any, value: Any) -> Any:
    """Return a value as the annotated type; None if it does not fit."""
    if isinstance(kind, types.GenericAlias):
        if not isinstance(value, list) or len(value) != len(typing.get_args(kind)):
            return None
        items = tuple(_value(float, item) for item in value)
        return None if None in items else items
    if kind is bool:
        return value if isinstance(value, bool) else None
    if kind is Lines:
        fits = isinstance(value, str) and len(value) <= _LONGEST_LINES and value.replace("\n", "").isprintable()
        return value if fits else None
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
