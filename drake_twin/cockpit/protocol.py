"""The requests that a browser may send; any other message is ignored."""

import json
import typing
from collections.abc import Mapping
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.typed_data import Reader, ValuePath

_LONGEST_TEXT = 1000
_LONGEST_LINES = 20_000

Lines = typing.NewType("Lines", str)  # a text of several lines
_MOST_STEPS = 10_000


class Request:
    """What a browser asks for."""


@dataclass(frozen=True)
class Play(Request):
    """Continue simulation time."""


@dataclass(frozen=True)
class Pause(Request):
    """Pause simulation time."""


@dataclass(frozen=True)
class Step(Request):
    """Make a number of physics steps and stay paused."""

    count: int


@dataclass(frozen=True)
class RunTo(Request):
    """Run until a simulation time (s) and pause there."""

    time: float


@dataclass(frozen=True)
class Reset(Request):
    """Reset the twin."""


@dataclass(frozen=True)
class Look(Request):
    """Pause, and draw again what was drawn at a simulation time (s)."""

    time: float


@dataclass(frozen=True)
class LookBy(Request):
    """Pause, and look so many pictures later, or earlier if it is negative."""

    count: int


@dataclass(frozen=True)
class Replay(Request):
    """Play what was drawn again, from the moment that is looked at, or pause that."""

    on: bool


@dataclass(frozen=True)
class Loop(Request):
    """Begin again where a replay, or a bag, ends, or no more."""

    on: bool


@dataclass(frozen=True)
class LookAtNow(Request):
    """Draw the present again."""


@dataclass(frozen=True)
class GoOnFrom(Request):
    """Return to the last moment that is kept before a simulation time (s), and continue from there."""

    time: float


@dataclass(frozen=True)
class SetRate(Request):
    """Set the real-time rate: simulated seconds per second of wall time."""

    rate: float


@dataclass(frozen=True)
class SetTimeStep(Request):
    """Set the physics step (s)."""

    seconds: float


@dataclass(frozen=True)
class Switch(Request):
    """Activate or deactivate a controller."""

    robot: str
    controller: str
    active: bool


@dataclass(frozen=True)
class SwitchTo(Request):
    """Activate a controller, and deactivate those that command the same joints."""

    robot: str
    controller: str


@dataclass(frozen=True)
class MoveJoint(Request):
    """Command one element of a topic (rad, rad/s, N·m, or m, m/s, N) and keep the others."""

    topic: str
    index: int
    value: float


@dataclass(frozen=True)
class PoseJoint(Request):
    """Set the joint position of a robot that is only displayed (rad or m)."""

    robot: str
    joint: str
    position: float


@dataclass(frozen=True)
class Drive(Request):
    """Drive a base with velocities (m/s, m/s, rad/s, m/s upwards), which hold while the request is repeated."""

    topic: str
    x: float
    y: float
    turn: float
    up: float = 0.0


@dataclass(frozen=True)
class EmergencyStop(Request):
    """Stop a robot and hold it there."""

    robot: str


@dataclass(frozen=True)
class ClearEmergencyStop(Request):
    """Clear a robot's emergency stop."""

    robot: str


@dataclass(frozen=True)
class Show(Request):
    """Show or hide an overlay."""

    what: str
    on: bool


@dataclass(frozen=True)
class ShowSensor(Request):
    """Show what a sensor measures, or no more: its key in the page's list."""

    sensor: str
    on: bool


@dataclass(frozen=True)
class ColorSensor(Request):
    """Color the points of a sensor by range, height or intensity, or with one color."""

    sensor: str
    by: str


@dataclass(frozen=True)
class LookAtEfforts(Request):
    """A tab shows efforts, for which the plant solves a step; repeated about once a second."""


@dataclass(frozen=True)
class LookAtRobots(Request):
    """A tab shows the joints and controllers of these robots only; repeated about once a second."""

    robots: tuple[str, ...]


@dataclass(frozen=True)
class Follow(Request):
    """Let the camera follow a robot, or no robot if the name is empty."""

    robot: str


@dataclass(frozen=True)
class Record(Request):
    """Start a recording as an HTML page, or end it and offer the page for download."""

    on: bool


@dataclass(frozen=True)
class Delete(Request):
    """Delete a robot."""

    robot: str


@dataclass(frozen=True)
class AskPanel(Request):
    """Ask the Python half of a panel: JSON data for its ``ask``."""

    panel: str
    data: Lines


@dataclass(frozen=True)
class Gone(Request):
    """A browser's connection has ended; the server adds this request, a browser cannot send it."""


_KINDS: dict[str, Any] = {kind.__name__: kind for kind in Request.__subclasses__() if kind is not Gone}


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
    request: Request | None = read_as(_KINDS, data)
    if isinstance(request, Step) and not 1 <= request.count <= _MOST_STEPS:
        return None
    return request


def read_as(kinds: Mapping[str, Any], data: Any) -> Any:
    """Return plain data, such as ``{"do": "Step", "count": 1}``, as the dataclass that ``do`` names.

    Args:
        kinds: Name → dataclass.
        data: The data, which may be anything that JSON holds.

    Returns:
        None if the data is not a mapping, the name is unknown, a field is missing, unknown or of the wrong type, or a
        number is not finite.
    """
    kind = data.get("do") if isinstance(data, dict) else None
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
