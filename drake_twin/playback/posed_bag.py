"""The robots of a bag, posed as at a moment of it."""

import logging
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from copy import deepcopy
from math import isfinite
from operator import attrgetter
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.messages.transform_tree import Transform
from drake_twin.playback.bag import JOINT_STATES, Bag, BagMessage
from drake_twin.playback.recorded_frames import RecordedFrames, RecordedRobot, is_frames
from drake_twin.twin.twin import Twin

_APART = 1.0  # s between two moments that are kept
_log = logging.getLogger(__name__)


def is_shown(topic: str, kind: str) -> bool:
    """Tell whether a topic moves the robots."""
    return kind == JOINT_STATES or is_frames(topic, kind)


@dataclass(frozen=True)
class _Moment:
    """What the messages until a time (s) have told, to continue from."""

    time: float
    frames: RecordedFrames
    joints: dict[str, dict[str, dict[str, float]]]


class PosedBag:
    """Poses the robots of a bag on a twin that has them and does not advance.

    Args:
        bag: The bag.
        twin: The twin.
        robots: Its robots, as they are in the bag.

    Attributes:
        time: The present moment (s since the bag's start).
        paused: Whether time stands still.
        loop: Whether it begins again where it ends.
        unplaced: The robots that no transform has placed, each with the link that it would place.
    """

    def __init__(self, bag: Bag, twin: Twin, robots: Sequence[RecordedRobot]):
        self._bag, self._twin, self._robots = bag, twin, tuple(robots)
        self._plans = {plan.name: plan for plan in twin.built.plans}
        self._said: set[str] = set()
        self.paused, self.loop = True, False
        self.unplaced: list[tuple[str, str]] = []
        self._moments: list[_Moment] = []  # by their times
        self.restart()

    def restart(self) -> None:
        """Go back to the bag's start."""
        self.time = 0.0
        self._messages: Iterator[BagMessage] = self._bag.messages(is_shown)
        self._next: BagMessage | None = next(self._messages, None)
        self._taken = 0.0  # the time of the last message that was taken (s)
        self._frames = RecordedFrames()
        self._joints: dict[str, dict[str, dict[str, float]]] = {robot.name: {} for robot in self._robots}

    def _keep(self, time: float) -> None:
        """Keep what is known before the messages of a time (s), if nothing near was kept."""
        last = self._moments[-1].time if self._moments else 0.0
        if time > self._taken >= last + _APART:
            self._moments.append(_Moment(self._taken, self._frames.copy(), deepcopy(self._joints)))

    def _continue_from(self, moment: _Moment) -> None:
        """Know what was known at a moment, and read on from there."""
        self.time = self._taken = moment.time
        self._frames = moment.frames.copy()
        self._joints = deepcopy(moment.joints)
        later = self._bag.messages(is_shown, since=moment.time)
        self._messages = (message for message in later if message.time > moment.time)
        self._next = next(self._messages, None)

    def look(self, time: float) -> None:
        """Pose the robots as at a time (s), be it earlier or later."""
        index = bisect_right(self._moments, time, key=attrgetter("time")) - 1
        if index >= 0 and (time < self.time or self._moments[index].time > self.time):
            self._continue_from(self._moments[index])
        elif time < self.time:
            self.restart()
        self.advance_to(min(max(time, 0.0), self._bag.duration))

    def advance_to(self, time: float) -> None:
        """Pose the robots as at a time (s) that is not before the present one; pause at the bag's end."""
        try:
            while self._next is not None and self._next.time <= time:
                self._keep(self._next.time)
                message, self._next = self._next, next(self._messages, None)
                self._taken = message.time
                if message.type == JOINT_STATES:
                    self._take(message.topic, message.read())
                else:
                    self._frames.add(message)
        except InputError as error:
            self._say(f"{error} The bag ends here, at {self.time:.3f} s")
            self._next, time = None, self.time
            self.paused = True
        self._pose()
        self.time = min(time, self._bag.duration)
        if time >= self._bag.duration and not self.paused:
            self.paused = True
            if not self.loop:
                self._say(f"the bag ends at {self._bag.duration:.3f} s")

    def _take(self, topic: str, message: Any) -> None:
        """Take the joint states that concern a robot: those in its namespace, or of the only robot."""
        namespace = topic.rpartition("/")[0]
        robots = [robot for robot in self._robots if len(self._robots) == 1 or robot.namespace == namespace]
        if not robots:  # such as one topic for all robots
            robots = list(self._robots)
        names, used = list(message.name), set()
        for robot in robots:
            joints = {joint.name for joint in self._plans[robot.name].description.movable_joints}
            used |= joints
            for field, values in (
                ("positions", message.position),
                ("velocities", message.velocity),
                ("efforts", message.effort),
            ):
                own = {name: float(value) for name, value in zip(names, values, strict=False) if name in joints}
                finite = {name: value for name, value in own.items() if isfinite(value)}
                self._joints[robot.name].setdefault(field, {}).update(finite)
        if others := [name for name in names if name not in used]:
            self._say(f"{topic}: no robot of the bag has the joints {', '.join(sorted(others))}")

    def _pose(self) -> None:
        roots, self.unplaced = set(), []
        for robot in self._robots:
            plan = self._plans[robot.name]
            if positions := self._joints[robot.name].get("positions"):
                leading = {joint.name for joint in plan.description.movable_joints if joint.mimic is None}
                known = {name: position for name, position in positions.items() if name in leading}
                self._twin.entities.set_joint_positions(robot.name, known)
            if plan.model.is_fixed:
                continue
            found = self._in_root(robot)
            if found is None:
                self.unplaced.append((robot.name, robot.root_link))
            else:
                root, pose = found
                roots.add(root)
                x, y, z, w = pose.rotation.as_quat()
                self._twin.entities.set_state(robot.name, position=pose.translation, orientation=(w, x, y, z))
        if len(roots) > 1:
            self._say(
                f"no transforms connect the frames {', '.join(sorted(roots))}: they are drawn as if they were one"
            )

    def _in_root(self, robot: RecordedRobot) -> tuple[str, Transform] | None:
        try:
            return self._frames.in_root(robot)
        except InputError as error:
            self._say(str(error))
            return None

    def _say(self, text: str) -> None:
        """Log a text once."""
        if text not in self._said:
            self._said.add(text)
            _log.warning("%s", text)
