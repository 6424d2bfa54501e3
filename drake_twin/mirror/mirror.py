"""A twin beside a robot: it hears what the robot hears and says, follows, compares, and raises alarms."""

import heapq
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from itertools import count
from types import MappingProxyType

from drake_twin.errors import CommandError, InputError
from drake_twin.messages.text import plain_data
from drake_twin.mirror.clock_match import Arrivals, ClockMatch
from drake_twin.mirror.detector import Detector, Judged
from drake_twin.mirror.follower import Follower, Gains, Innovation, Measured
from drake_twin.mirror.heard import Heard
from drake_twin.mirror.profile import Profile, command_delay, learn
from drake_twin.mirror.robot_watch import Alarm, RobotWatch
from drake_twin.mirror.watched import Watched, WatchedTopics, watched_topics
from drake_twin.scenario import Scenario
from drake_twin.twin.endpoints import COMMANDED, PUBLISHED
from drake_twin.twin.twin import Twin

WINDOW = 0.05  # s for which messages wait for those that were sent before them and come later
FIRST = 20.0  # s at the start that are learned from, without a profile
_SHORTEST_PERIOD = 0.005  # s between two measurements of a topic that are looked at
_SILENCE = 0.5  # s without a message that are an alarm
LOST = "connection_lost"


class Mirror:
    """Follows a robot, or several.

    It only listens: nothing that it does reaches the robot.

    Args:
        scenario: The twin; its own commands are left out, unless the robot's are not heard.
        known: The robot's topics with their types; None for those that the twin has.
        renamed: Topic of the robot → topic of the twin, where they differ.
        source: Where the robot's topics come from, for errors.
        profile: What was learned of the healthy robot; None to learn from the first seconds.
        gains: How fast the twin follows.
        time_to_false_alarm: The mean time to a false alarm (s).
        learns: Whether all of the run is learned from, for `learned`, and nothing is judged.
        judged: Is called with each measurement, once it is judged.
        followed: Is called with each measurement, once the twin has followed it.

    Attributes:
        twin: The twin that follows.
        topics: The robot's topics that are used.
        clocks: Robot → its clock beside the listener's.
        alarms: The alarms so far, of which those without an end last.
        notes: What was noticed of the messages.
        profile: What the robot is compared with; None while it is learned.
        zero: The listener's time at which the twin's began (s); None before the first message.

    Raises:
        InputError: If the scenario cannot be built, or nothing of what is measured belongs to a robot of the twin.
    """

    def __init__(
        self,
        scenario: Scenario,
        known: Mapping[str, str] | None = None,
        renamed: Mapping[str, str] = MappingProxyType({}),
        *,
        source: str = "the robot",
        profile: Profile | None = None,
        gains: Gains | None = None,
        time_to_false_alarm: float = 3600.0,
        learns: bool = False,
        judged: Callable[[Judged], None] = lambda _: None,
        followed: Callable[[Innovation], None] = lambda _: None,
    ):
        self.twin = Twin(replace(scenario, commands=(), sensor_noise=False))
        try:
            self.topics = topics = self._watched(known, renamed, source)
        except InputError:
            self.twin.close()
            raise
        commands = "" if topics.commands else "the commands of the robot are not heard: "
        if commands and scenario.commands:
            self.twin.close()
            self.twin = Twin(replace(scenario, sensor_noise=False))
            commands += "the twin has those of its scenario, from the first message on"
        elif commands:
            commands += "the twin follows what is measured, and a weak motor cannot be told from a slow command"
        self._follower = Follower(self.twin, gains)
        self._time_to_false_alarm = time_to_false_alarm
        self._followed = followed
        self.profile = profile
        self._command_delay = 0.0 if profile is None else profile.command_delay
        self._arrivals = {topic: Arrivals() for topic in topics.topics}
        self._last_heard: dict[str, float] = {}
        self._taken: dict[str, float] = {}
        self._waiting: list[tuple[float, int, Heard]] = []
        self._order = count()
        self._now = float("-inf")
        self.zero: float | None = None
        self.notes: list[str] = [*filter(None, [commands]), *topics.notes]
        self._noted: set[str] = set()
        self._first: dict[tuple[str, str], str] = {}  # robot and what is measured → the topic that does so
        self._learning: list[Innovation] = []
        self._knows_delay = False
        self._learns = learns
        robots = sorted({item.robot for item in topics.measured.values()})
        self.clocks = {robot: ClockMatch() for robot in robots}
        self.alarms: list[Alarm] = []
        self._robots = {robot: RobotWatch(robot, self.twin, self.alarms, judged) for robot in robots}
        if profile is not None:
            try:
                self._watch(profile)
            except InputError:
                self.twin.close()
                raise

    def _watched(self, known: Mapping[str, str] | None, renamed: Mapping[str, str], source: str) -> WatchedTopics:
        endpoints = self.twin.graph.endpoints
        if known is None:
            known = {item.name: item.type for item in endpoints if item.kind in (PUBLISHED, COMMANDED)}
            own = {ours: theirs for theirs, ours in renamed.items()}
            known = {own.get(name, name): kind for name, kind in known.items()}
            return watched_topics(known, endpoints, renamed, source, are_there=False)
        return watched_topics(known, endpoints, renamed, source)

    @property
    def arrivals(self) -> dict[str, Arrivals]:
        """What arrived of each topic."""
        return self._arrivals

    @property
    def catches(self) -> int:
        """How often the twin was set where the robot is, because it was far off or had heard nothing for a while."""
        return self._follower.catches

    def hear(self, heard: Heard) -> None:
        """Take a message, and follow the robot up to the messages that are complete by now."""
        topic = heard.topic
        if topic not in self._arrivals:
            return
        time = heard.received
        watched = self.topics.measured.get(topic)
        if watched is None:
            time += self._command_delay
        elif (stamp := heard.stamp) is not None:
            clock = self.clocks[watched.robot]
            resets = clock.resets
            time = clock.heard(heard.received, stamp)
            if clock.resets != resets:
                self.note(f"{topic}: the robot's clock was set at {heard.received:.3f} s")
        if watched is not None and (first := self._first.setdefault((watched.robot, watched.kind), topic)) != topic:
            self.note(f"{topic} is not used: {watched.robot} has {first} for this")
            return
        self._arrivals[topic].add(time)
        self._last_heard[topic] = max(heard.received, self._last_heard.get(topic, heard.received))
        heapq.heappush(self._waiting, (time, next(self._order), heard))
        self.proceed(heard.received)

    def proceed(self, now: float, *, all_of_it: bool = False) -> None:
        """Let time pass: follow up to what is complete by now.

        Args:
            now: The listener's time (s).
            all_of_it: Whether nothing more will be heard.
        """
        self._now = max(self._now, now)
        until = float("inf") if all_of_it else self._now - WINDOW
        while self._waiting and self._waiting[0][0] <= until:
            time, _, heard = heapq.heappop(self._waiting)
            self._do(time, heard)
        self._look_for_silence()

    @property
    def robots(self) -> tuple[str, ...]:
        """The robots that are followed."""
        return tuple(self._robots)

    def condition(self, robot: str) -> tuple[str, int, str]:
        """Return a robot, 0 (as its twin), 1 (an alarm is over, or it is being learned) or 2 (alarm), and a text."""
        own = [alarm for alarm in self.alarms if alarm.robot == robot]
        lasting = [alarm for alarm in own if alarm.ended is None]
        if lasting:
            return robot, 2, lasting[-1].text
        if self.profile is None:
            return robot, 1, "what is healthy is being learned"
        return (robot, 1, f"no alarm now; before: {own[-1].text}") if own else (robot, 0, "as its twin")

    def measured(self, robot: str) -> Measured | None:
        """Return where a robot was measured last; None before anything was."""
        return self._follower.measured.get(robot)

    def levels(self) -> dict[str, float]:
        """Return for each number that is compared how far it is on its way to an alarm; one is an alarm."""
        found: dict[str, float] = {}
        for watch in self._robots.values():
            if watch.detector is not None:
                found |= watch.detector.levels()
        return found

    def learned(self) -> Profile:
        """Return what the whole run teaches.

        Raises:
            InputError: If it is too short.
        """
        return learn(self._learning, self._command_delay)

    def summary(self) -> str:
        """Return what was heard, in one line."""
        zero = self.zero
        if zero is None:
            return "nothing was heard of the robot"
        seconds = self.twin.time
        rates = [f"{topic} {own.count}" for topic, own in sorted(self._arrivals.items()) if own.count]
        verdict = f"{len(self.alarms)} alarm{'' if len(self.alarms) == 1 else 's'}" if self.alarms else "no alarm"
        return f"followed {', '.join(self.robots)} for {seconds:.1f} s ({', '.join(rates)} messages): {verdict}"

    def close(self) -> None:
        """Free the twin."""
        self.twin.close()

    # One message -----------------------------------------------------------------------------------------------------

    def _do(self, time: float, heard: Heard) -> None:
        if self.zero is None:
            self.zero = time
        own = max(time - self.zero, 0.0)
        watched = self.topics.measured.get(heard.topic)
        if watched is None:
            self._command(own, heard)
        else:
            self._measure(own, watched, heard)

    def _command(self, time: float, heard: Heard) -> None:
        fields = plain_data(heard.message)
        if isinstance(fields, dict) and "header" in fields:
            fields["header"]["stamp"] = {"sec": 0, "nanosec": 0}  # at once: the robot's clock is another
        self._follower.advance_to(time)
        try:
            self.twin.publish(self.topics.commands[heard.topic], fields)
        except CommandError as error:
            if heard.topic not in self._noted:
                self._noted.add(heard.topic)
                self.notes.append(f"{heard.topic}: the twin refuses a command: {error.message}")

    def _measure(self, time: float, watched: Watched, heard: Heard) -> None:
        last = self._taken.get(watched.topic, float("-inf"))
        if time - last < _SHORTEST_PERIOD:
            if time < last:
                self.note(f"{watched.topic}: messages that came too late are left out")
            return
        if time < self.twin.time - WINDOW:
            self.note(f"{watched.topic}: messages that came too late are left out")
            return
        self._taken[watched.topic] = time
        innovation = self._follower.measure(time, watched, heard.message)
        while self._follower.notes:
            self.note(self._follower.notes.pop())
        if innovation is None:
            self.note(f"{watched.topic}: a message without a number that the twin has is left out")
            return
        self._followed(innovation)
        if self.profile is None:
            self._learn(innovation)
        else:
            self._robots[watched.robot].judge(innovation, self.zero or 0.0)

    def _learn(self, innovation: Innovation) -> None:
        self._learning.append(innovation)
        if not self._knows_delay and innovation.time >= FIRST / 2:  # what was simulated so far was too early
            self._command_delay += command_delay(self._learning)
            self._knows_delay = True
            self._learning.clear()
        elif innovation.time >= 1.5 * FIRST and not self._learns:
            self.profile = learn(self._learning, self._command_delay)
            self._learning.clear()
            self._watch(self.profile)

    def _watch(self, profile: Profile) -> None:
        if not profile.topics.keys() & self.topics.measured.keys():
            listed = ", ".join(profile.topics) or "none"
            what = f"the profile is of other topics ({listed}): learn one of this robot"
            raise InputError(what, valid=self.topics.measured)
        for topic in self.topics.measured.keys() - profile.topics.keys():
            self.note(f"{topic} is followed, but not compared: the profile does not have it")
        for robot, watch in self._robots.items():
            own = frozenset(item.topic for item in self.topics.measured.values() if item.robot == robot)
            stands = self.twin.built.robots[robot].layout.has_moving_base
            watch.detector = Detector(profile, own, self._time_to_false_alarm, stands=stands)

    def _look_for_silence(self) -> None:
        for topic, watched in self.topics.measured.items():
            arrivals, last = self._arrivals[topic], self._last_heard.get(topic)
            if last is None or arrivals.count < 10:
                continue
            is_silent = self._now - last > max(_SILENCE, 5 * arrivals.period)
            robot = self._robots[watched.robot]
            known = robot.silent.get(topic)
            if is_silent and known is None:
                text = f"nothing was heard on {topic} since {last:.2f} s: the connection, or its sender, is gone"
                robot.silent[topic] = len(self.alarms)
                self.alarms.append(Alarm(watched.robot, LOST, (topic,), text, last, self._now))
            elif not is_silent and known is not None:
                self.alarms[known] = replace(self.alarms[known], ended=self._now)
                del robot.silent[topic]

    def note(self, text: str) -> None:
        """Take note of something, once."""
        if text not in self._noted:
            self._noted.add(text)
            self.notes.append(text)


def follow(mirror: Mirror, messages: Iterable[Heard]) -> None:
    """Let a mirror hear all of a bag."""
    for heard in messages:
        mirror.hear(heard)
    mirror.proceed(mirror._now, all_of_it=True)
