"""A log of a robot: what it was commanded and what was measured, by the topics of its twin.

Times are those of the log's first command or measurement on. A measurement counts at the stamp of its header; without
one, when it was recorded.
"""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from drake_twin.calibration.measured import JOINT_STATES, NUMBERS, continuous
from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.messages.text import plain_data
from drake_twin.playback.bag import Bag, BagMessage
from drake_twin.twin.endpoints import COMMANDED, PUBLISHED, Endpoint

_OTHER_CLOCK = 0.5  # s between stamps and recording, from which on the stamps are of a clock of their own
_LATER = 0.01  # s after its recording, from which on the stamp of a trajectory is when it begins

Series = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class LoggedCommand:
    """A command: its time (s), the twin's topic, and its message as `Twin.publish` takes it."""

    time: float
    topic: str
    fields: Any


@dataclass(frozen=True)
class Measured:
    """What was measured on a topic.

    Attributes:
        topic: The log's topic.
        twin_topic: The twin's topic that it is compared with.
        series: Name of a number → its times (s) and values, each of shape (N,).
    """

    topic: str
    twin_topic: str
    series: Mapping[str, Series]


@dataclass(frozen=True)
class Log:
    """A log.

    Attributes:
        name: Its file.
        commands: The commands, in order.
        measured: The measurements.
        notes: What of the log is not used, and why.
    """

    name: str
    commands: tuple[LoggedCommand, ...]
    measured: tuple[Measured, ...]
    notes: tuple[str, ...] = ()

    @property
    def end(self) -> float:
        """The time of the last measurement (s)."""
        return max(float(times[-1]) for item in self.measured for times, _ in item.series.values())

    @property
    def first_command(self) -> float:
        """The time of the first command (s)."""
        return self.commands[0].time


@dataclass(frozen=True)
class _Found:
    """A topic of a log that its twin has, too."""

    topic: str
    kind: str
    twin_topic: str


def read_bag(file: Path, endpoints: Sequence[Endpoint], renamed: Mapping[str, str]) -> Log:
    """Read a rosbag2 bag.

    Args:
        file: Its folder, or a file in it.
        endpoints: The topics of the twin.
        renamed: Topic of the log → topic of the twin, where they differ.

    Raises:
        InputError: If the bag cannot be read, or lacks commands or measurements that belong together.
    """
    with Bag(file) as bag:
        known = {name: kind for name, (kind, _) in bag.topics.items()}
        for topic in renamed:
            if topic not in known:
                raise InputError("--map: the bag lacks this topic", file=file, value=topic, valid=known)
        commanded = _matching(file, known, endpoints, COMMANDED, renamed)
        if not commanded:
            valid = [item.name for item in endpoints if item.kind == COMMANDED]
            raise InputError(
                f"no topic of the bag commands the twin: {', '.join(known)} (--map BAG_TOPIC=TWIN_TOPIC)",
                file=file,
                valid=valid,
            )
        compared = _matching(file, known, endpoints, PUBLISHED, renamed)
        if not compared:
            valid = [item.name for item in endpoints if item.kind == PUBLISHED and item.type in NUMBERS]
            raise InputError(
                f"no topic of the bag is one that the twin measures: {', '.join(known)} (--map BAG_TOPIC=TWIN_TOPIC)",
                file=file,
                valid=valid,
            )
        used = {*(item.topic for item in commanded), *(item.topic for item in compared)}
        notes = [f"{topic} is not used" for topic in known if topic not in used]
        commands = [
            (message.time, found.twin_topic, _fields(message, bag))
            for found in commanded
            for message in bag.messages(lambda topic, _, own=found.topic: topic == own)  # type: ignore[misc]
        ]
        series = [(found, _series(bag, found, notes)) for found in compared]
    return made_log(str(file), commands, [(a.topic, a.twin_topic, s) for a, s in series], notes)


def made_log(
    name: str,
    commands: Sequence[tuple[float, str, Mapping[str, Any]]],
    measured: Sequence[tuple[str, str, Mapping[str, Series]]],
    notes: Sequence[str] = (),
) -> Log:
    """Return a log that begins at its first command or measurement.

    Raises:
        InputError: If there are no numbers, or commands and measurements do not overlap in time.
    """
    commands = sorted(commands, key=lambda item: item[0])
    measured = [item for item in measured if item[2]]
    if not measured:
        raise InputError("nothing was measured that the twin has, too", file=name)
    begins = min(float(times[0]) for _, _, series in measured for times, _ in series.values())
    ends = max(float(times[-1]) for _, _, series in measured for times, _ in series.values())
    if not commands or ends <= commands[0][0] or begins > commands[-1][0]:
        spans = f"{commands[0][0]:.3f} to {commands[-1][0]:.3f} s" if commands else "never"
        raise InputError(
            f"commands ({spans}) and measurements ({begins:.3f} to {ends:.3f} s) do not overlap in time", file=name
        )
    zero = min(begins, commands[0][0])
    own = [Measured(a, b, {key: (t - zero, v) for key, (t, v) in series.items()}) for a, b, series in measured]
    return Log(
        name,
        tuple(LoggedCommand(time - zero, topic, fields) for time, topic, fields in commands),
        tuple(own),
        tuple(notes),
    )


def _matching(
    file: Path, known: Mapping[str, str], endpoints: Sequence[Endpoint], kind: str, renamed: Mapping[str, str]
) -> list[_Found]:
    """Return the log's topics that the twin listens to (COMMANDED), or publishes and that are compared (PUBLISHED).

    Raises:
        InputError: If ``renamed`` joins topics of different types, or names one that the twin lacks.
    """
    own = {item.name: item for item in endpoints if item.kind == kind}
    every = {item.name for item in endpoints}
    found = []
    for topic, type_name in known.items():
        other = own.get(renamed.get(topic, topic))
        if topic in renamed and renamed[topic] not in every:
            raise InputError("--map: the twin lacks this topic", value=renamed[topic], valid=every)
        if other is None and kind == PUBLISHED and type_name == JOINT_STATES and topic not in renamed:
            states = [item for item in own.values() if item.type == JOINT_STATES]
            other = states[0] if len(states) == 1 else None
        if other is None:
            continue
        if kind == COMMANDED and type_name != other.type:
            raise InputError(f"{topic} is a {type_name}, but the twin's {other.name} is a {other.type}", file=file)
        if kind == COMMANDED or (type_name in NUMBERS and other.type in NUMBERS):
            found.append(_Found(topic, type_name, other.name))
    return found


def _series(bag: Bag, found: _Found, notes: list[str]) -> dict[str, Series]:
    """Return the numbers of a topic over time; those that are NaN throughout were not measured."""
    times: list[float] = []
    shifts: list[float] = []
    rows: list[dict[str, float]] = []
    for message in bag.messages(lambda topic, _: topic == found.topic):
        content = message.read()
        stamp = _stamp(content, bag)
        times.append(message.time if stamp is None else stamp)
        shifts.append(message.time - times[-1])
        rows.append(NUMBERS[found.kind](content))
    shift = float(np.median(shifts)) if shifts else 0.0
    if abs(shift) > _OTHER_CLOCK:
        notes.append(f"{found.topic}: its stamps are of another clock, {shift:.3f} s behind: they are moved by this")
        times = [time + shift for time in times]
    order = np.argsort(times, kind="stable")
    return series_of(found.topic, [times[i] for i in order], [rows[i] for i in order], notes)


def series_of(
    topic: str, times: Sequence[float], rows: Sequence[Mapping[str, float]], notes: list[str]
) -> dict[str, Series]:
    """Return the numbers of messages by name, without those that are NaN throughout: they were not measured."""
    series: dict[str, Series] = {}
    absent: list[str] = []
    for name in dict.fromkeys(key for row in rows for key in row):
        own = [(time, row[name]) for time, row in zip(times, rows, strict=True) if name in row]
        at, values = np.array(own).T
        if np.isnan(values).all():
            absent.append(name)
        else:
            series[name] = at, continuous(name, values)
    if absent:
        notes.append(f"{topic}: not measured: {', '.join(absent)}")
    return series


def without(log: Log, names: Collection[str]) -> Log:
    """Return a log without some topics or numbers.

    Raises:
        InputError: If a name is unknown, nothing is left, or a number that is left is NaN or infinite in some messages.
    """
    valid = {name for item in log.measured for name in (item.topic, *item.series)}
    for name in names:
        if name not in valid:
            raise InputError("--without: the log has no such topic or number", file=log.name, value=name, valid=valid)
    left = [
        Measured(item.topic, item.twin_topic, {key: own for key, own in item.series.items() if key not in names})
        for item in log.measured
        if item.topic not in names
    ]
    if not any(item.series for item in left):
        raise InputError("--without leaves nothing to compare", file=log.name)
    for item in left:
        for name, (times, values) in item.series.items():
            if not (finite := np.isfinite(values)).all():
                first = int(np.argmin(finite))
                what = f"{item.topic}: {name} is {values[first]} at {times[first]:.3f} s of the log"
                raise InputError(f"{what}: --without {name} leaves it out", file=log.name)
    return Log(log.name, log.commands, tuple(item for item in left if item.series), log.notes)


def _stamp(message: Any, bag: Bag) -> float | None:
    """Return the time of a message's header (s since the bag's start); None without one."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    if stamp is None or not (stamp.sec or stamp.nanosec):
        return None
    return float(stamp.sec * 10**9 + stamp.nanosec - bag.start) * 1e-9


def _fields(message: BagMessage, bag: Bag) -> dict[str, Any]:
    """Return a command's fields, without the stamp of another clock: zero means at once."""
    content = message.read()
    fields: dict[str, Any] = plain_data(content)
    stamp = _stamp(content, bag)
    if stamp is not None:
        later = stamp - message.time
        if _LATER < later < _OTHER_CLOCK * 100:
            raise InputError(f"{message.topic}: the command at {message.time:.3f} s is to begin {later:.3f} s later")
        fields["header"]["stamp"] = {"sec": 0, "nanosec": 0}
    return fields
