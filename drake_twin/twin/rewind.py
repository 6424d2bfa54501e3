"""The last minute of a twin: moments to return to, and marks of what happened."""

import pickle
from bisect import bisect_right
from collections import deque
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from pydrake.geometry import GeometryId

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError, RunError
from drake_twin.findings import Kind, texts
from drake_twin.twin.owner import Owned
from drake_twin.twin.recording import CONTROLLER_MANAGER
from drake_twin.twin.snapshot import Snapshot
from drake_twin.twin.touching import models_of_shapes, touching
from drake_twin.twin.twin import Twin
from drake_twin.values import is_number

COMMAND, CONTACT, FAULT = "command", "contact", "fault"  # the kinds of marks

_SECONDS, _PERIOD = 60.0, 0.5
_MOST_BYTES = 50_000_000
_LONGEST = 3600.0  # s
_MOST_MARKS = 1000
_JOINED = 1.0  # s: what happens again within this time extends its mark
_JUMPS = ("reset", "restore")
_EPSILON = 1e-9  # s


@dataclass(frozen=True)
class Mark:
    """What happened.

    Attributes:
        kind: `COMMAND`, `CONTACT` or `FAULT`.
        text: What it was, for example ``publish /robot_1/cmd_vel`` or ``robot_1 touches robot_2``.
        start: When it began (s). A contact or fault is noticed at the next moment that is kept.
        end: When it happened for the last time without a break of a second (s).
    """

    kind: str
    text: str
    start: float
    end: float


@dataclass(frozen=True)
class _Moment:
    """A moment that is kept: its time (s), its scenario as YAML, and all else, packed."""

    time: float
    scenario: str
    packed: bytes

    @property
    def snapshot(self) -> Snapshot:
        return Snapshot(scenario=self.scenario, **pickle.loads(self.packed))


class Rewind(Owned, path="rewind"):
    """Keeps moments of a twin on a grid of simulation times as it advances, and returns to them.

    The state is only read, so that a run with it is the same to the last bit. Moments that a reset, a restored state
    or `go_to` leaves in the future are dropped: what is kept leads to the present. Close it to keep nothing more; it is
    a context manager that does so.

    Args:
        twin: The twin.
        seconds: How long a moment is kept (simulated s).
        period: The time between two moments (simulated s).
        most_bytes: The most memory for moments; the oldest are dropped earlier.

    Raises:
        InputError: If a value is invalid.
    """

    def __init__(
        self, twin: Twin, seconds: float = _SECONDS, period: float = _PERIOD, most_bytes: float = _MOST_BYTES
    ) -> None:
        for name, value in (("seconds", seconds), ("period", period)):
            if not is_number(value) or not 0.0 < value <= _LONGEST:
                raise InputError(f"{value!r} is not valid for {name}: it must be above 0 s and at most {_LONGEST:g} s")
        if not is_number(most_bytes) or most_bytes <= 0:
            raise InputError(f"{most_bytes!r} is not valid for most_bytes: it must be above zero")
        self._owner = twin.owner
        self._twin, self._seconds, self._most_bytes = twin, float(seconds), most_bytes
        self._moments: deque[_Moment] = deque()
        self._size: int | None = 0  # bytes; None until it is asked for after a change
        self._models: tuple[object, dict[GeometryId, str]] = None, {}
        self._marks: dict[tuple[str, str, float], Mark] = {}  # by kind, text and start
        self._last: dict[tuple[str, str], Mark] = {}
        self._touching: frozenset[str] = frozenset()
        self._faults: frozenset[str] = frozenset(texts(twin.findings, Kind.FAILED))
        self._is_asked = False
        self._period = float(period)
        self._is_open = False
        self.open()

    @property
    def times(self) -> tuple[float, ...]:
        """The times of the moments that one can return to (s), ascending."""
        self._drop_future()
        return tuple(moment.time for moment in self._moments)

    @property
    def marks(self) -> tuple[Mark, ...]:
        """What happened since the first moment, by its start."""
        return tuple(sorted(self._marks.values(), key=lambda mark: (mark.start, mark.kind, mark.text)))

    @property
    def size(self) -> int:
        """The memory that the moments take (bytes)."""
        if self._size is None:
            texts_of = {id(moment.scenario): len(moment.scenario) for moment in self._moments}
            self._size = sum(len(moment.packed) for moment in self._moments) + sum(texts_of.values())
        return self._size

    def go_to(self, time: float) -> float:
        """Return the twin to the last moment that is not after a time; the moments after it are dropped.

        To a recording of the twin this is a `Twin.restore`, so that it replays.

        Args:
            time: A simulation time (s).

        Returns:
            The time of that moment (s).

        Raises:
            InputError: If the time lies before the first moment or after the present, or if called inside a callback.
        """
        times, now = self.times, self._twin.time
        if not times:
            raise InputError(f"no moment is kept yet: the twin has not advanced since {now:g} s")
        if not is_number(time) or not times[0] - _EPSILON <= time <= now + _EPSILON:
            raise InputError(f"{time!r} s is not a time to return to: it must be from {times[0]:g} s to {now:g} s")
        moment = self._moments[max(0, bisect_right(times, time + _EPSILON) - 1)]
        self._twin.restore(moment.snapshot)
        self._drop_future()
        return moment.time

    def open(self) -> None:
        """Keep moments again after `close`."""
        if not self._is_open:
            self._is_open = True
            self._twin.recorder.listeners.append(self._hear)
            self._end_subscription = self._twin.subscribe("/clock", lambda _: self._ask(), rate=1.0 / self._period)

    def close(self) -> None:
        """Keep no further moments; those that are kept can still be returned to."""
        if self._is_open:
            self._is_open = False
            self._end_subscription()
            self._twin.recorder.listeners.remove(self._hear)

    def __enter__(self) -> "Rewind":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _ask(self) -> None:
        """Ask the twin, inside a callback, to let a moment be kept: a snapshot needs the end of an advance."""
        if not self._is_asked:
            self._is_asked = True
            self._twin.alarm.requests.append(self._keep)

    def _keep(self) -> None:
        """Keep the present moment."""
        self._is_asked = False
        if not self._is_open:
            return
        self._drop_future()
        twin = self._twin
        self._size = None
        if self._moments and self._moments[-1].time >= twin.time - _EPSILON:
            self._moments.pop()
        snapshot = twin.snapshot()
        self._moments.append(_Moment(twin.time, snapshot.scenario, pickle.dumps(snapshot.state(), protocol=5)))
        self._look_for_faults()
        self._look_for_contacts()
        oldest = twin.time - self._seconds - _EPSILON
        while len(self._moments) > 1 and (self._moments[0].time < oldest or self.size > self._most_bytes):
            self._moments.popleft()
            self._size = None
        first = self._moments[0].time
        self._marks = {key: mark for key, mark in self._marks.items() if mark.end >= first}
        self._last = {key: mark for key, mark in self._last.items() if mark.end >= first}

    def _drop_future(self) -> None:
        """Drop what is after the present: the twin was returned to an earlier moment."""
        now = self._twin.time + _EPSILON
        if not self._moments or self._moments[-1].time <= now:
            return
        while self._moments and self._moments[-1].time > now:
            self._moments.pop()
        self._size = None
        past = {key: mark for key, mark in self._marks.items() if mark.start <= now}
        self._marks = {key: replace(mark, end=min(mark.end, self._twin.time)) for key, mark in past.items()}
        self._last.clear()
        self._touching = frozenset()

    def _hear(self, name: str, arguments: tuple[Any, ...]) -> None:
        if name in _JUMPS:
            self._drop_future()
            return
        if name == CONTROLLER_MANAGER:
            robot, name, *_ = arguments
            arguments = (robot,)
        about = (item if isinstance(item, str) else getattr(item, "name", "") for item in arguments)
        words = [name.replace("_", " "), *(item for item in about if isinstance(item, str) and item)]
        self._mark(COMMAND, " ".join(words[:2]))

    def _look_for_faults(self) -> None:
        faults = frozenset(texts(self._twin.findings, Kind.FAILED))
        for text in sorted(faults - self._faults):
            self._mark(FAULT, text)
        self._faults = faults

    def _look_for_contacts(self) -> None:
        if self._models[0] is not self._twin.built.shapes:
            self._models = self._twin.built.shapes, models_of_shapes(self._twin)
        now = frozenset(_touching(self._twin, self._models[1]))
        for text in sorted(now - self._touching):
            self._mark(CONTACT, text)
        self._touching = now

    def _mark(self, kind: str, text: str) -> None:
        now, last = self._twin.time, self._last.get((kind, text))
        start = last.start if last is not None and now - last.end <= _JOINED else now
        if (kind, text, start) not in self._marks and len(self._marks) >= _MOST_MARKS:
            del self._marks[next(iter(self._marks))]
        mark = Mark(kind, text, start, now)
        self._marks[kind, text, start] = self._last[kind, text] = mark


def _touching(twin: Twin, models: Mapping[GeometryId, str]) -> set[str]:
    """Return which robots and moving models of the world touch each other."""
    try:
        facets, points = touching(twin, models)
    except RunError:  # the next step fails, which says why
        return set()
    return {f"{a} touches {b}" for a, b in {*facets, *points} if a and a != b}
