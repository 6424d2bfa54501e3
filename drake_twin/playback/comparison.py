"""The panel that lays a bag over a run or another bag: its robots as ghosts, its curves dashed, the differences."""

import time as wall_clock
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Protocol

from drake_twin.cockpit import protocol
from drake_twin.cockpit.panel import panel
from drake_twin.cockpit.protocol import read_as
from drake_twin.cockpit.scene import Scene
from drake_twin.cockpit.topics_panel import Plot
from drake_twin.dataclass import dataclass
from drake_twin.description.package_index import absolute_path
from drake_twin.errors import InputError
from drake_twin.messages import shortened
from drake_twin.playback.bag import TRANSFORMS, Bag
from drake_twin.playback.posed_bag import PosedBag
from drake_twin.playback.robots import recorded_scenario
from drake_twin.playback.series import Series, differences, reading, slides_of, within
from drake_twin.shared_viewer.frame_sender import Frame
from drake_twin.shared_viewer.shared_scene import SharedScene
from drake_twin.twin.endpoints import PUBLISHED
from drake_twin.twin.twin import Twin

GHOSTS = "/compared"  # the path of the other's robots
_OPACITY = 0.35
_BUDGET = 0.02  # s of wall time that each snapshot reads on
_SENT = 4  # snapshots that a curve is sent with
_LISTED = 20  # differences
_AGAIN = 15  # snapshots, about 1 s, between two tables of a run
_NO_LATER = 1e8  # s: a bag that begins later has the wall clock's time
_MOST_A_SECOND = 50.0  # messages of a topic of a run
_LEAST_RANGE = 0.01  # of values: what varies less is not compared with its own range
_EQUAL = 1e-9  # of the values' range: what is not further apart is the same
_NOT_COMPARED = (
    TRANSFORMS,
    *(f"sensor_msgs/msg/{name}" for name in ("Image", "CompressedImage", "PointCloud", "PointCloud2", "LaserScan")),
    "diagnostic_msgs/msg/DiagnosticArray",
    "control_msgs/msg/DynamicJointState",  # says what joint_states say
    "rosgraph_msgs/msg/Clock",
    "std_msgs/msg/String",
    "rcl_interfaces/msg/Log",
)


@dataclass(frozen=True)
class Open:
    """Compare with a bag: its folder on the machine of the twin."""

    bag: str


@dataclass(frozen=True)
class Close:
    """Compare no more."""


class Own(Protocol):
    """What is compared: a run, or the bag that is played."""

    start: float

    def topics(self) -> dict[str, str]:
        """Return its topics, with their types."""

    def read(self, topic: str, series: Series) -> Iterator[None]:
        """Read on in a topic."""

    def close(self) -> None:
        """Read no more."""


class OwnRun:
    """A run: its messages from now on.

    Args:
        twin: The twin.
    """

    start = 0.0  # s

    def __init__(self, twin: Twin):
        self._twin = twin
        self._ends: list[Callable[[], None]] = []

    def topics(self) -> dict[str, str]:
        """Return its topics, with their types."""
        return {item.name: item.type for item in self._twin.graph.endpoints if item.kind == PUBLISHED}

    def read(self, topic: str, series: Series) -> Iterator[None]:
        """Take the topic's messages as they come, from now on."""
        rate = next(item.rate for item in self._twin.graph.endpoints if (item.kind, item.name) == (PUBLISHED, topic))
        seldom = rate / -(-rate // _MOST_A_SECOND) if rate else None
        self._ends.append(self._twin.subscribe(topic, lambda message: series.add(self._twin.time, message), seldom))
        return iter(())

    def close(self) -> None:
        """Listen no more."""
        for end in self._ends:
            end()
        self._ends.clear()


class OwnBag:
    """A bag that is played.

    Args:
        bag: The bag.
    """

    def __init__(self, bag: Bag):
        self._bag = bag
        self.start = bag.start * 1e-9

    def topics(self) -> dict[str, str]:
        """Return its topics, with their types."""
        return {topic: kind for topic, (kind, _) in self._bag.topics.items()}

    def read(self, topic: str, series: Series) -> Iterator[None]:
        """Read on in a topic."""
        return reading(self._bag, topic, series)

    def close(self) -> None:
        """Do nothing: who opened the bag closes it."""


@panel("compare", Path(protocol.__file__).with_name("static") / "compare_panel.js")
class Comparison:
    """Lays a bag over what the page shows.

    Args:
        twin: The twin.
        own: What is compared; by default the twin's run.
    """

    def __init__(self, twin: Twin, own: Own | None = None):
        self._twin = twin
        self._own: Own = own or OwnRun(twin)
        self._other: _Other | None = None
        self._problem = ""
        self._gone = False  # its robots are still to be deleted from the scene

    def state(self) -> dict[str, Any]:
        """Return the bag's name, the table of differences, and the curves that were asked for."""
        if self._other is None:
            return {"name": "", "problem": self._problem}
        try:
            return self._other.state()
        except InputError as error:
            self._close()
            self._problem = str(error)
            return {"name": "", "problem": self._problem}

    def ask(self, data: Any) -> None:
        """Do what a tab asks; why a bag cannot be opened is part of the state.

        Raises:
            InputError: If the request is not one.
        """
        match read_as({"Open": Open, "Close": Close, "Plot": Plot}, data):
            case Open(folder):
                self._problem = ""
                try:
                    self.open(Path(folder))
                except InputError as error:
                    self._problem = str(error)
            case Close():
                self._problem = ""
                self._close()
            case Plot() as plot:
                if self._other is not None:
                    self._other.want(plot)
            case _:
                raise InputError(f"unknown request {shortened(data)} of the panel that compares")

    def open(self, folder: Path) -> None:
        """Compare with a bag.

        Args:
            folder: Its folder.

        Raises:
            InputError: If it cannot be read.
        """
        other = _Other(Path(absolute_path(folder.expanduser())), self._own, self._twin)
        self._close()
        self._other = other

    def draw(self, scene: Scene, time: float) -> None:
        """Draw the other's robots at a time (s)."""
        if self._gone:
            self._gone = False
            scene.delete_beside(GHOSTS)
        if self._other is not None:
            self._other.draw(scene, time)

    def close(self) -> None:
        """Compare no more."""
        self._close()

    def _close(self) -> None:
        if self._other is not None:
            self._other.close()
            self._other = None
            self._gone = True


class _Other:
    """A bag that is compared with something."""

    def __init__(self, folder: Path, own: Own, twin: Twin):
        self._bag, self._own = Bag(folder), own
        try:
            # Two runs by simulation time are laid over each other by it, others by their starts.
            start = self._bag.start * 1e-9
            self.shift = start - own.start if max(start, own.start) < _NO_LATER else 0.0
            self.name = folder.name
            self._player: PosedBag | None = None
            if self._bag.descriptions:
                scenario, robots = recorded_scenario(self._bag, twin.scenario.package_paths)
                self._ghost = Twin(scenario)
                self._player = PosedBag(self._bag, self._ghost, robots)
                self._drawn = SharedScene(self._ghost)
        except BaseException:
            self._bag.close()
            raise
        slides = slides_of(twin.built.plans)
        others = {topic: kind for topic, (kind, _) in self._bag.topics.items()}
        common = [
            topic for topic, kind in own.topics().items() if others.get(topic) == kind and kind not in _NOT_COMPARED
        ]
        self._series = {topic: (Series(slides), Series(slides)) for topic in sorted(common)}
        self._own_reading = {topic: own.read(topic, mine) for topic, (mine, _) in self._series.items()}
        self._work = self._reading()
        self._is_read = False
        self._read = 0  # topics
        self._snapshots = 0
        self._length = -1
        self._table: list[dict[str, Any]] = []
        self._wanted: dict[Plot, int] = {}  # → snapshots that it is still sent with

    def want(self, plot: Plot) -> None:
        self._wanted[plot] = _SENT

    def state(self) -> dict[str, Any]:
        if not self._is_read:
            self._is_read = within(_BUDGET, wall_clock.perf_counter, self._work)
        if self._is_read and self._snapshots % _AGAIN == 0:
            self._compare()
        self._snapshots += self._is_read
        curves = {}
        for plot in self._wanted:
            _, series = self._series.get(plot.topic, (None, None))
            if series is None or (self._is_read and plot.field not in series.fields):
                curves[f"{plot.topic}.{plot.field}"] = {"times": [], "values": [], "unit": ""}
            elif self._is_read:
                curves[f"{plot.topic}.{plot.field}"] = series.curve(plot.field, self.shift)
        self._wanted = {plot: left - 1 for plot, left in self._wanted.items() if left > 1 or not self._is_read}
        return {
            "name": self.name,
            "problem": "",
            "progress": None if self._is_read else round(self._read / max(1, len(self._series)), 2),
            "topics": len(self._series),
            "meet": any(self._meet(own.times, other.times) for own, other in self._series.values()),
            "until": round(self._bag.duration + self.shift, 3),
            "table": self._table,
            "curves": curves,
        }

    def _meet(self, own: list[float], other: list[float]) -> bool:
        """Return whether messages of the two are of the same time."""
        return bool(own and other) and own[0] <= other[-1] + self.shift and other[0] + self.shift <= own[-1]

    def draw(self, scene: Scene, time: float) -> None:
        if self._player is None:
            return
        at = min(max(time - self.shift, 0.0), self._bag.duration)
        if at != self._player.time or self._length < 0:
            self._length = max(0, self._length)
            self._player.look(at)
            scene.show_beside(GHOSTS, Frame(self._drawn, self._drawn.poses(self._ghost)), _OPACITY)

    def close(self) -> None:
        self._own.close()
        self._bag.close()

    def _reading(self) -> Iterator[None]:
        for topic, (_, other) in self._series.items():
            yield from reading(self._bag, topic, other)
            yield from self._own_reading[topic]
            self._read += 1

    def _compare(self) -> None:
        """Make the table again if there are further messages."""
        length = sum(len(own.times) for own, _ in self._series.values())
        if length == self._length:
            return
        self._length = length
        found = []
        for topic, (own, other) in self._series.items():
            rows = list(differences(own, other, self.shift))
            ranges = dict.fromkeys(own.units.values(), _LEAST_RANGE)
            for field, _, _, extent in rows:  # x, y and z of one thing are compared with the largest of them
                ranges[own.units[field]] = max(ranges[own.units[field]], extent)
            for field, apart, at, extent in rows:
                if apart > _EQUAL * max(extent, _EQUAL):
                    row = {"topic": topic, "field": field, "difference": apart, "at": at, "unit": own.units[field]}
                    found.append((apart / ranges[own.units[field]], row))
        found.sort(key=lambda item: -item[0])
        self._table = [row for _, row in found[:_LISTED]]
