"""The requests that a browser may send; any other message is ignored."""

import json
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from drake_twin.typed_data import Reader, ValuePath

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
    try:
        return _Reader(_unfit).read(kinds[kind], {name: value for name, value in data.items() if name != "do"})
    except _UnfitError:
        return None


class _UnfitError(Exception):
    pass


def _unfit(path: ValuePath, message: str, **more: Any) -> _UnfitError:
    return _UnfitError(message)


class _Reader(Reader):
    largest = 2**31

    def read_scalar(self, kind: Any, value: Any, path: ValuePath) -> Any:
        if not isinstance(value, str):
            return super().read_scalar(str if kind is Lines else kind, value, path)
        longest, shown = (_LONGEST_LINES, value.replace("\n", "")) if kind is Lines else (_LONGEST_TEXT, value)
        if kind not in (str, Lines) or len(value) > longest or not shown.isprintable():
            raise self.error(path, "this is not such a text")
        return value
