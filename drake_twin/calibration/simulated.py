"""The twin, commanded as a log says: what it would have measured, for any values."""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from drake_twin.calibration.log import Log, LoggedCommand, Series
from drake_twin.calibration.measured import JOINT_STATES, NUMBERS, continuous
from drake_twin.errors import CommandError, InputError, RunError
from drake_twin.scenario import Scenario, ScenarioError
from drake_twin.sweeps.variation import with_value
from drake_twin.twin.twin import Twin

LEAST_RATE = 200.0  # Hz of samples, between which is interpolated
_MORE = 0.03  # s of samples beyond the last measurement, between which is interpolated
_SPEED = 0.02  # rad/s or m/s from which on a joint moves at the start

Simulated = dict[str, dict[str, Series]]


def with_values(scenario: Scenario, values: Mapping[str, float]) -> Scenario:
    """Return a scenario with values.

    Raises:
        InputError: If a path or a value cannot be used.
    """
    for path, value in values.items():
        try:
            scenario = with_value(scenario, path, value)
        except ScenarioError as error:
            raise InputError(f"{path}={value:g}: {error.reason}", **error.more) from None
    return scenario


class SimulatedLog:
    """A twin that repeats a log, from the joint positions that it begins with.

    Args:
        scenario: What to run; its commands are the log's.
        log: The log.
        margin: How long to simulate beyond the last measurement (s).

    Attributes:
        log: The log, without what the twin does not measure.
        samples_of_start: Name of a joint's position → of how many measurements its start is the mean.

    Raises:
        InputError: If the twin measures nothing of what the log has, or refuses a command.
    """

    def __init__(self, scenario: Scenario, log: Log, margin: float):
        self.samples_of_start: dict[str, int] = {}
        notes = list(log.notes)
        self._base = self._started(scenario, log, notes)
        self._twin = Twin(self._base)
        self._end = log.end + margin + _MORE
        self._messages: dict[str, list[tuple[float, object]]] = {}
        self._types = {item.name: item.type for item in self._twin.graph.endpoints}
        for item in log.measured:
            self._observe(item.twin_topic)
        self.log = self._comparable(log, notes)

    def run(self, values: Mapping[str, float], moved: Mapping[str, float] = MappingProxyType({})) -> Simulated:
        """Simulate the log.

        Args:
            values: Path → value.
            moved: Joint → by how much it begins elsewhere (rad or m).

        Returns:
            The twin's topic → name of a number → its times (s) and values.

        Raises:
            InputError: If a value cannot be used.
            RunError: If the simulation fails.
        """
        self._start(values)
        for robot in self._base.robots if moved else ():
            begins = robot.initial_positions
            own = {joint: begins[joint] + way for joint, way in moved.items() if joint in begins}
            self._twin.entities.set_joint_positions(robot.name, own)
        for command in self.log.commands:
            if command.time > self._twin.time:
                self._twin.advance_to(command.time)
            self._publish(command)
        self._twin.advance_to(max(self._end, self._twin.time))
        return {topic: self._series(topic) for topic in self._messages}

    def start_at(self, values: Mapping[str, float]) -> Scenario:
        """Return the scenario with values, from the log's start.

        Raises:
            InputError: If a path or a value cannot be used.
        """
        self._twin.reset(scenario := with_values(self._base, values))
        return scenario

    def close(self) -> None:
        """Free the twin."""
        self._twin.close()

    def _start(self, values: Mapping[str, float]) -> None:
        self.start_at(values)
        for received in self._messages.values():
            received.clear()

    def _publish(self, command: LoggedCommand) -> None:
        try:
            self._twin.publish(command.topic, command.fields)
        except CommandError as error:
            text = f"the twin refuses the command at {command.time:.3f} s: {error.message}"
            raise InputError(text, file=self.log.name, valid=error.valid, value=error.value) from None

    def _observe(self, topic: str) -> None:
        if topic in self._messages:
            return
        received: list[tuple[float, object]] = []
        self._messages[topic] = received
        twin = self._twin
        rate = min(LEAST_RATE, 1.0 / twin.clock.time_step)
        twin.subscribe(topic, lambda message: received.append((twin.time, message)), rate=rate)

    def _series(self, topic: str) -> dict[str, Series]:
        numbers = NUMBERS[self._types[topic]]
        received = self._messages[topic]
        if len(received) < 2:
            raise RunError(f"the twin sends no messages on {topic}: is its controller active?")
        times = np.array([time for time, _ in received])
        rows = [numbers(message) for _, message in received]
        series = {name: np.array([row.get(name, np.nan) for row in rows]) for name in rows[-1]}
        return {name: (times, continuous(name, own)) for name, own in series.items()}

    def _comparable(self, log: Log, notes: list[str]) -> Log:
        """Return the log without the numbers that the twin lacks."""
        self._start({})
        self._twin.advance_to(2.0 / LEAST_RATE + self._twin.clock.time_step)
        own = {topic: self._series(topic) for topic in self._messages}
        kept = []
        for item in log.measured:
            finite = {name for name, (_, values) in own[item.twin_topic].items() if np.isfinite(values).all()}
            common = {name: series for name, series in item.series.items() if name in finite}
            logged = item.series.keys()
            absent = finite - logged if self._types[item.twin_topic] == JOINT_STATES else set()
            for names, words in ((logged - finite, "not in the twin"), (absent, "not in the log")):
                if names:
                    notes.append(f"{item.topic}: {words}: {', '.join(sorted(names))}")
            if common:
                kept.append(replace(item, series=common))
        if not kept:
            measured = sorted({name for item in log.measured for name in item.series})
            twins = sorted({name for series in own.values() for name in series})
            raise InputError(
                f"the twin has none of the log's numbers: {', '.join(measured)}", file=log.name, valid=twins
            )
        return Log(log.name, log.commands, tuple(kept), tuple(notes))

    def _started(self, scenario: Scenario, log: Log, notes: list[str]) -> Scenario:
        """Return the scenario with the joint positions at the log's start, and without commands and noise."""
        robots = []
        with Twin(scenario) as twin:
            own_topics = {item.name: item for item in twin.graph.endpoints}
            for plan in twin.built.plans:
                positions: dict[str, float] = {}
                for item in log.measured:
                    endpoint = own_topics[item.twin_topic]
                    if endpoint.type == JOINT_STATES and endpoint.robot == plan.name:
                        positions |= self._positions(item.series, log.first_command, notes)
                known = {
                    joint.name: positions[joint.name]
                    for joint in plan.description.movable_joints
                    if joint.name in positions and joint.mimic is None
                }
                start = {**plan.robot.initial_positions, **known}
                robots.append(replace(plan.robot, initial_positions=start))
        return replace(scenario, robots=tuple(robots), commands=(), sensor_noise=False)

    def _positions(self, series: Mapping[str, Series], first_command: float, notes: list[str]) -> dict[str, float]:
        found = {}
        moving = []
        for name, (times, values) in series.items():
            joint, _, kind = name.rpartition(".")
            before = max(1, int(np.searchsorted(times, first_command)))
            if kind == "position":
                found[joint] = float(np.mean(values[:before]))
                self.samples_of_start[name] = before
            elif kind == "velocity" and abs(np.mean(values[:before])) > _SPEED + 3 * np.std(values[:before]):
                moving.append(joint)
        if moving:
            notes.append(f"{', '.join(moving)} may move already when the log begins; the twin begins at rest")
        return found
