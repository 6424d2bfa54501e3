"""The alarms of one robot: when they begin, what they look like, when they are over."""

from collections import deque
from collections.abc import Callable
from dataclasses import replace

from drake_twin.dataclass import dataclass
from drake_twin.mirror.detector import Detector, Judged
from drake_twin.mirror.evidence import Evidence
from drake_twin.mirror.follower import Innovation
from drake_twin.mirror.looks_like import looks_like
from drake_twin.twin.twin import Twin

_KEPT = 6.0  # s of measurements that are looked at to tell what an alarm looks like
_SETTLING = 3.0  # s at the start, in which clocks and heights are found
_LOOKS = 2.0  # s after an alarm began in which its kind may still change
_OVER = 0.5  # of the threshold below which an alarm ends,
_OVER_FOR = 1.0  # s after which it does


@dataclass(frozen=True)
class Alarm:
    """An alarm.

    Attributes:
        robot: The robot.
        kind: What it looks like; one of `drake_twin.mirror.looks_like.KINDS`, or ``connection_lost``.
        parts: The joints or topics that it is about.
        text: What that means, in words.
        began: When the change began (s, on the listener's clock).
        raised: When it was noticed (s).
        ended: When it was over (s); None while it lasts.
    """

    robot: str
    kind: str
    parts: tuple[str, ...]
    text: str
    began: float
    raised: float
    ended: float | None = None


class RobotWatch:
    """Raises and ends the alarms of one robot.

    Args:
        robot: The robot's name.
        twin: The twin.
        alarms: Where its alarms are put.
        judged: Is called with each measurement, once it is judged.

    Attributes:
        detector: What compares the robot with its twin; None while that is learned.
        silent: Topic from which nothing is heard → the number of the alarm that tells so.
    """

    def __init__(self, robot: str, twin: Twin, alarms: list[Alarm], judged: Callable[[Judged], None]):
        self.robot = robot
        self._twin, self._alarms, self._judged = twin, alarms, judged
        self.detector: Detector | None = None
        self.silent: dict[str, int] = {}
        self._zero = 0.0
        self._kept: deque[Judged] = deque()
        self._alarm: int | None = None
        self._quiet_since: float | None = None
        self._next_look = 0.0
        self._above: set[tuple[str, str]] = set()  # the numbers that the alarm is about

    def judge(self, innovation: Innovation, zero: float) -> None:
        """Judge a measurement.

        Args:
            innovation: The measurement.
            zero: The listener's time at which the twin's began (s).
        """
        self._zero = zero
        assert self.detector is not None
        judged = self.detector.judge(innovation)
        self._judged(judged)
        time = innovation.time
        self._kept.append(judged)
        while time - self._kept[0].time > _KEPT:
            self._kept.popleft()
        excess = self.detector.excess()[0]
        if self._alarm is None and excess > 1.0 and time > _SETTLING:
            self._raise(time)
        elif self._alarm is not None:
            self._follow_alarm(time, excess)

    def _raise(self, time: float) -> None:
        assert self.detector is not None
        above = self.detector.above()
        began = max(self.detector.began(time, above - self._above), 0.0)
        self._alarm, self._above, self._quiet_since = len(self._alarms), above, None
        self._alarms.append(Alarm(self.robot, "", (), "", began + self._zero, time + self._zero))
        self._look(time)

    def _follow_alarm(self, time: float, excess: float) -> None:
        assert self._alarm is not None
        assert self.detector is not None
        alarm = self._alarms[self._alarm]
        is_new = time + self._zero - alarm.raised < _LOOKS
        above = self.detector.above()
        if is_new:
            self._above |= above
            if time >= self._next_look:
                self._look(time)
        elif not above <= self._above:  # something else has changed, too
            self._alarms[self._alarm] = replace(alarm, ended=time + self._zero)
            self._raise(time)
            return
        if excess >= _OVER:
            self._quiet_since = None
        elif self._quiet_since is None:
            self._quiet_since = time
        elif time - self._quiet_since > _OVER_FOR:
            self._alarms[self._alarm] = replace(self._alarms[self._alarm], ended=self._quiet_since + self._zero)
            self._alarm, self._above = None, set()

    def _look(self, time: float) -> None:
        """Tell what the alarm looks like by now."""
        assert self._alarm is not None
        assert self.detector is not None
        self._next_look = time + 0.25
        alarm = self._alarms[self._alarm]
        evidence = Evidence(self._twin, self.robot, self._kept, alarm.began - self._zero, self.detector)
        kind, parts, text = looks_like(evidence)
        self._alarms[self._alarm] = replace(alarm, kind=kind, parts=parts, text=text)
