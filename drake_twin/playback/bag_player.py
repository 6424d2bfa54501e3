"""A bag on the page, which steers its time."""

from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cached_property
from typing import Any

from drake_twin.cockpit import protocol
from drake_twin.cockpit.panel import Panel
from drake_twin.cockpit.scene import Scene
from drake_twin.errors import InputError
from drake_twin.playback.bag import Bag
from drake_twin.playback.bag_sensors import BagSensors
from drake_twin.playback.bag_topics import BagTopics
from drake_twin.playback.comparison import Comparison, OwnBag
from drake_twin.playback.posed_bag import PosedBag
from drake_twin.playback.recorded_frames import RecordedRobot
from drake_twin.playback.series import slides_of
from drake_twin.twin.twin import Twin

_STEP = 1 / 30  # s of a step on the page
_OF_PHYSICS = ("massless_link", "inertia", "effort_limit", "joint_friction")  # repairs
_LOG, _MOST_LOGS = "rcl_interfaces/msg/Log", 200
_LEVELS = {30: "warning", 40: "error", 50: "error"}
_LONGEST_FRAME = 0.2  # s of wall time that one frame makes up for: a slow page plays slower


class BagPlayer(PosedBag):
    """Plays a bag on a twin that has its robots and does not advance.

    Args:
        bag: The bag.
        twin: The twin.
        robots: Its robots, as they are in the bag.

    Attributes:
        rate: Seconds of the bag per second of wall time.
        comparison: What lays another bag over it.
        panels: What its topics and its comparison are on the page.
        findings: What became of the robots' shapes and joints; their masses and contacts do not matter here.
    """

    def __init__(self, bag: Bag, twin: Twin, robots: Sequence[RecordedRobot]):
        super().__init__(bag, twin, robots)
        self.findings = tuple(item for item in twin.findings if item.rule and item.rule not in _OF_PHYSICS)
        self._stop_at: float | None = None
        self.rate = 1.0
        slides = slides_of(twin.built.plans)
        self.comparison = Comparison(twin, OwnBag(bag))
        topics = BagTopics(bag, slides, lambda: self.time, lambda: self._frames)
        self.panels: dict[str, Panel] = {"topics": topics, "compare": self.comparison}

    @cached_property
    def logs(self) -> tuple[tuple[str, str, float], ...]:
        """The last messages of the bag's logs: kind, text and time (s)."""
        lines: deque[tuple[str, str, float]] = deque(maxlen=_MOST_LOGS)
        with suppress(InputError):  # of a damaged bag, which is said where it ends
            for line in self._bag.messages(lambda topic, kind: kind == _LOG):
                item = line.read()
                lines.append((_LEVELS.get(item.level, "info"), f"{item.name}: {item.msg}", line.time))
        return tuple(lines)

    def sensors(self, scene: Scene, send: Callable[[str, bytes], None]) -> BagSensors:
        """Return what the page shows of the bag's sensors; see `Player`."""
        return BagSensors(self._bag, lambda: self.time, lambda frame: self._frames.in_top(frame), scene, send)

    def proceed(self, wall_time: float) -> None:
        """Play what a frame of wall time (s) shows."""
        if self.paused:
            return
        target = self.time + self.rate * min(wall_time, _LONGEST_FRAME)
        if self._stop_at is not None and target >= self._stop_at:
            target, self._stop_at, self.paused = self._stop_at, None, True
        self.advance_to(target)
        if self.loop and self.paused and self.time >= self._bag.duration:
            self.restart()
            self.paused = False

    def do(self, request: protocol.Request) -> None:
        """Process a request of the page about time.

        Raises:
            InputError: If a bag cannot do what is asked for.
        """
        match request:
            case protocol.Play():
                if self.time >= self._bag.duration or self._next is None:
                    self.restart()
                self.paused = False
            case protocol.Pause():
                self.paused = True
            case protocol.Step(count):
                self.paused = True
                self.advance_to(self.time + count * _STEP)
            case protocol.RunTo(time):
                if time <= self.time:
                    raise InputError(
                        f"{time:g} s lies in the past: the bag is at {self.time:g} s. Reset it to start again"
                    )
                self._stop_at, self.paused = time, False
            case protocol.Reset():
                self.restart()
                self.advance_to(0.0)
            case protocol.Look(time):
                self.paused = True
                self.look(time)
            case protocol.LookBy(count):
                self.do(protocol.Look(self.time + count * _STEP))
            case protocol.Loop(on):
                self.loop = on
            case protocol.SetRate(rate):
                if rate <= 0:
                    raise InputError(f"{rate:g} is not a speed: it is positive")
                self.rate = rate
            case _:
                raise InputError(f"{type(request).__name__}: a bag is only shown, nothing in it can be changed")

    def amend(self, state: dict[str, Any]) -> None:
        """Put what the bag says into a state of the page: time, and the joints' velocities and efforts."""
        state.update(time=round(self.time, 9), paused=self.paused, rate=self.rate, steps=0)
        state.update(duration=self._bag.duration, loop=self.loop)
        for name, joints in self._joints.items():
            order = self._twin.robot_state(name).joints
            for field in ("velocities", "efforts"):
                known = joints.get(field, {})
                state["robots"][name][field] = [round(known.get(joint, 0.0), 6) for joint in order]
