"""The parts of a running twin, and the one list of its state.

A part has ``state()``, which returns its entries of a `Snapshot` as plain data, and ``set_state()``. From this list
follow snapshots, restoring, building the diagram again, replay and ``state_sha256``.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Protocol

from pydrake.geometry import Meshcat
from pydrake.systems.framework import Context

from drake_twin.diagram.twin_diagram import Extension, TwinDiagram
from drake_twin.errors import InputError, RunError, TwinError
from drake_twin.findings import Finding, Kind
from drake_twin.messages import shortened
from drake_twin.planning.robot_plan import RobotPlan, has_other_parameters, is_same_robot
from drake_twin.scenario import Scenario, ScenarioError
from drake_twin.scenario.absolute_files import with_files_found
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml
from drake_twin.sensors.sensor_host import sensor_hosts
from drake_twin.twin.alarm import Alarm
from drake_twin.twin.clock import Clock
from drake_twin.twin.commands import Commands
from drake_twin.twin.event_topics import ROSOUT, EventTopics
from drake_twin.twin.failure import failure, is_possible
from drake_twin.twin.goals import Goals
from drake_twin.twin.owner import Owner
from drake_twin.twin.parameter_changes import ParameterChanges
from drake_twin.twin.physics import Physics
from drake_twin.twin.reactions import Reactions
from drake_twin.twin.robot_control import RobotControl
from drake_twin.twin.rosout import TwinLog, log_of
from drake_twin.twin.snapshot import Snapshot
from drake_twin.twin.state import RobotState, hash_plain, read_robot_state
from drake_twin.twin.subscriptions import Subscriptions
from drake_twin.twin.sunk import sunk_robots
from drake_twin.twin.varied_parameters import SET_AT_START, needs_build
from drake_twin.twin.wrenches import Wrenches, first_wrenches

# What goes wrong with saved values of another kind than they should be; some of Drake's checks end the process.
_UNFIT = (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RuntimeError, TwinError, SystemExit)


class Part(Protocol):
    """A part of a twin that has state."""

    def state(self) -> dict[str, Any]:
        """Return the entries of a snapshot that this part keeps, as plain data."""

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entries that `state` returned."""


class Session:
    """A running scenario: its diagram and everything that has state.

    Args:
        scenario: What to run.
        meshcat: The page to draw on.
        plans: Plans of its robots that were made before.
        extensions: Add a user's own systems to the diagram.
        note: Takes note of calls to the controllers.
        owner: The thread that it belongs to.

    Attributes:
        owner: The thread that it belongs to.
        scenario: The scenario.
        first_robots: The names of the robots at the start.
        clock: The time.
        physics: The diagram, its simulator and the state of its plant.
        built: The diagram's parts.
        controls: Robot → its controllers.
        commands: The commands of all controllers.
        wrenches: What pushes links.
        goals: The goals of actions.
        subscriptions: The callbacks of topics.
        simulated: The time that has been simulated since the session was made (s), also before resets.
        alarm: The stops for node programs.
        is_advancing: Returns whether an advance is under way, so that the diagram cannot be built.
        parameters: What is set of the controllers' parameters.
        events: The topics that no port of the diagram has.
        reactions: What the session does by itself between two steps.
        triggers: That of them which publishes messages when it hears one.
        sunk: Robot → findings about what it stood in when it came.
    """

    def __init__(
        self,
        scenario: Scenario,
        meshcat: Meshcat | None,
        plans: Iterable[RobotPlan],
        extensions: Sequence[Extension],
        note: Callable[..., object],
        owner: Owner,
    ):
        self._meshcat, self._extensions, self._note, self.owner = meshcat, tuple(extensions), note, owner
        self.scenario = self._given = scenario = with_files_found(scenario)
        self._text: tuple[Scenario | None, str] = None, ""  # as YAML
        self.first_robots = tuple(robot.name for robot in scenario.robots)
        self.clock = Clock(scenario.time_step)
        self.commands, self.wrenches, self.goals = Commands(), Wrenches(), Goals()
        self.controls: dict[str, RobotControl] = {}
        self.subscriptions = Subscriptions(scenario.time_step)
        self.simulated = 0.0
        self.is_advancing: Callable[[], bool] = lambda: False
        self.alarm = Alarm(owner, scenario.time_step)
        self.events = EventTopics(owner, lambda: self.clock.time)
        self.reactions = Reactions(self.clock, self.events, self.subscriptions)
        self.triggers = self.reactions.triggers
        self.triggers.publication = self._publication
        self.parameters = ParameterChanges(self, lambda: self.clock.time)
        TwinLog(self.events[ROSOUT])
        self._use(Physics(scenario, meshcat, plans=plans, extensions=self._extensions))
        self._start()
        self.sunk: dict[str, tuple[Finding, ...]] = self.find_sunk(tuple(self.controls))

    @property
    def built(self) -> TwinDiagram:
        """The diagram's parts."""
        return self.physics.built

    @property
    def robots(self) -> tuple[str, ...]:
        """The robots' names."""
        return tuple(plan.name for plan in self.built.plans)

    def plan(self, robot: Any) -> RobotPlan:
        """Return a robot's plan.

        Raises:
            InputError: If the robot is unknown.
        """
        for plan in self.built.plans:
            if plan.name == robot:
                return plan
        raise InputError(f"unknown robot {shortened(robot)}", value=str(robot), valid=self.robots)

    def control(self, robot: Any) -> RobotControl:
        """Return a robot's controllers.

        Raises:
            InputError: If the robot is unknown.
        """
        known = self.controls.get(robot) if isinstance(robot, str) else None
        return known or self.controls[self.plan(robot).name]

    def robot_state(self, robot: Any, *, with_efforts: bool) -> RobotState:
        """Return a robot's state.

        Raises:
            InputError: If the robot is unknown.
            RunError: If Drake cannot solve the step to come, which efforts are read from.
        """
        plan = self.plan(robot)
        try:
            return read_robot_state(self.built, self.physics.context, plan, with_efforts=with_efforts)
        except (RuntimeError, SystemExit) as error:
            raise self.failure(error) from error

    def find_sunk(self, robots: Sequence[str]) -> dict[str, tuple[Finding, ...]]:
        """Return findings about robots that stand in something else."""
        return sunk_robots(self.built, self.physics.context, robots)

    def check_commands(self, check: Callable[[str, Any], object]) -> None:
        """Drop the scenario's optional commands that no controller accepts, each with a finding.

        Args:
            check: Called with the topic and the data of each command; raises what is wrong with it.

        Raises:
            ScenarioError: If a controller does not accept a command that is not optional.
        """
        kept, findings = [], []
        for index, command in enumerate(self.scenario.commands):
            try:
                check(command.topic, command.data)
            except InputError as error:
                reason = str(error).rstrip(".")
                if not command.optional:
                    raise ScenarioError(("commands", index), reason) from None
                findings.append(Finding(Kind.NOT_STARTED, f"ros2 topic pub {command.topic} ({reason})"))
            else:
                kept.append(replace(command, optional=False))
        if findings or kept != [*self.scenario.commands]:
            known = self.scenario.findings
            rest = self.built.findings[len(known) :]
            self.scenario = replace(self.scenario, commands=tuple(kept), findings=(*known, *findings))
            self.physics.built = replace(self.built, findings=(*known, *findings, *rest))
            self.commands.start(self.scenario.commands)

    def faults(self) -> Iterator[Finding]:
        """Yield what has failed: controllers, and sensors of other packages."""
        for control in self.controls.values():
            yield from control.faults
        for sensor in (sensor for host in sensor_hosts(self.built.diagram) for sensor in host.sensors):
            if sensor.fault is not None:
                what = f"sensor {sensor.setup.sensor.name}: {sensor.fault}"
                yield Finding(Kind.FAILED, what, sensor.setup.owner)

    def failure(self, error: BaseException) -> RunError:
        """Return what Drake raises at the present time as an error for the user."""
        return failure(self.built, self.physics.plant_context, self.clock.time, error)

    def between_advances(self, act: Callable[[], None]) -> None:
        """Do what a callback cannot do, once the present advance has ended."""
        self.alarm.requests.append(act)

    def parts(self) -> tuple[Part, ...]:
        """Return everything that has state."""
        return (
            self.clock,
            self.physics,
            self.commands,
            self.wrenches,
            *self.controls.values(),
            self.parameters,
            self.reactions,
        )

    def state(self) -> dict[str, Any]:
        """Return all entries of a snapshot but the scenario."""
        found: dict[str, Any] = {}
        for part in self.parts():
            for name, value in part.state().items():
                if name == "robots":
                    robots = found.setdefault("robots", {})
                    for robot, entries in value.items():
                        robots.setdefault(robot, {}).update(entries)
                else:
                    found[name] = value
        return found

    def handed_out(self) -> Context:
        """Return the root context for a user, who may change parameters in it from now on."""
        self.physics.is_handed_out = True
        return self.physics.context

    def state_sha256(self) -> str:
        """Return the hash of all entries of a snapshot but the scenario."""
        return hash_plain(self.state())

    def snapshot(self) -> Snapshot:
        """Return the present moment."""
        if self._text[0] is not self.scenario:
            self._text = self.scenario, scenario_to_yaml(self.scenario)
        return Snapshot(scenario=self._text[1], **self.state())

    def restore(self, snapshot: Snapshot) -> None:
        """Set the state of a snapshot; without a change if its scenario cannot be used, else reset if its state cannot.

        Raises:
            InputError: If the snapshot cannot be used.
        """
        before = self.clock.time
        scenario, text = self._text
        if scenario is None or text != snapshot.scenario:
            scenario = ScenarioFile(snapshot.scenario, "snapshot").as_written
        if snapshot.time_step != scenario.time_step:
            raise InputError(f"the saved state has steps of {snapshot.time_step} s, and its scenario others")
        self.goals.drop_all()
        self.clock.next_time_step = None
        self._change_to(scenario)
        self._start()
        state = snapshot.state()
        try:
            self.clock.set_state(state)
            self.physics.context.SetTime(self.physics.time_of(self.clock.step))
            for part in self.parts():
                part.set_state(state)
            if self.clock.next_time_step is not None:
                self.clock.next_time_step = replace(scenario, time_step=self.clock.next_time_step).time_step
            self.physics.detachable_joints.follow()
            plant = self.built.plant
            if not is_possible(plant.GetPositionsAndVelocities(self.physics.plant_context)):
                raise ValueError("positions or velocities are not finite")
        except _UNFIT as error:
            self.clock.next_time_step = None
            self.reset()
            reason = " ".join(str(error).split())
            raise InputError(f"the saved state does not fit the robots that it names ({reason})") from None
        self.physics.initialize()
        self.subscriptions.begin(self.clock.time)
        self.alarm.jumped(before)

    def reset(self, scenario: Scenario | None = None, check: Callable[[str, Any], object] | None = None) -> None:
        """Return to the start: time zero, start positions, no commands, the scenario's commands ahead.

        Args:
            scenario: The scenario to start; by default the present one.
            check: Checks the commands of a scenario that is given, as for `check_commands`.

        Raises:
            InputError: If the scenario cannot be built; nothing is changed then.
        """
        before = self.clock.time
        if scenario is not None:
            self._change_to(with_files_found(scenario))
            self.clock.next_time_step = None
        self.goals.drop_all()
        self.commands.silenced.clear()
        self._start()
        self.subscriptions.begin(0.0)
        self.alarm.jumped(before)
        if scenario is not None and check is not None:
            self.check_commands(check)

    def rebuild(self, scenario: Scenario, plans: Iterable[RobotPlan] = ()) -> None:
        """Switch to the diagram of another scenario, and transfer all state that has a place in it.

        Args:
            scenario: The scenario, whose files have been found.
            plans: Plans of its robots that were made before, beside those of the present ones.

        Raises:
            InputError: If the scenario cannot be built; nothing is changed then.
        """
        old = self.physics
        physics = Physics(scenario, self._meshcat, old.built, plans, self._extensions)
        state, before, known = self.state(), self.scenario.commands, dict(self.controls)
        self.scenario = self._given = scenario
        if scenario.time_step != self.clock.time_step:
            self.clock.use(scenario.time_step)
        physics.context.SetTime(physics.time_of(self.clock.step))
        self._use(physics)
        for name, control in self.controls.items():
            if control is not known.get(name):
                control.start()
        physics.transfer(state, old)
        self.commands.transfer(state, before, scenario.commands)
        for name, control in self.controls.items():
            if name in known and is_same_robot(control.plan, known[name].plan):
                control.set_state(state)
        self.physics.detachable_joints.follow()
        self.wrenches.put(self.wrenches.items)
        self.subscriptions.use(scenario.time_step)
        self.alarm.use(scenario.time_step)
        self.alarm.hasten(self.clock.time)
        physics.initialize()
        old.discard()
        self.subscriptions.look_again()

    def _publication(self, port: str) -> Any:
        """Return the time (s) at which the present message of a port was published; None if it is new."""
        item = self.built.published.get(port)
        return None if item is None or item.publication is None else item.publication(self.physics.context)

    def _change_to(self, scenario: Scenario) -> None:
        """Use another scenario: set its values if that suffices, else build its diagram."""
        if not needs_build(self.scenario, scenario, self.built.plans):
            self.physics.use(scenario)
            self.scenario = scenario
        elif not needs_build(self._given, scenario, self.built.plans):  # its optional commands are checked already
            self.physics.use(scenario)
            same = {name: getattr(scenario, name) for name in SET_AT_START}
            self.scenario = replace(self.scenario, **same)
            self._given = scenario
        else:
            self.rebuild(scenario)

    def _start(self) -> None:
        self.clock.go_to(0)
        self.physics.start_at_rest()
        self.commands.start(self.scenario.commands)
        self.wrenches.start(self.physics.pushes, first_wrenches(self.built))
        self.reactions.start()
        for control in self.controls.values():
            control.start()
        self.physics.detachable_joints.follow()
        self.physics.initialize()

    def _use(self, physics: Physics) -> None:
        """Let all parts work with a newly built diagram."""
        self.physics = physics
        controls = {}
        for plan in physics.built.plans:
            control = self.controls.get(plan.name)
            if control is not None and has_other_parameters(plan, control.plan):
                control.follow(plan)
            elif control is None or control.plan is not plan:
                control = RobotControl(plan, self.commands.clear, self._note, self.owner)
                control.manager.loaded = partial(self.parameters.loaded, plan.name)
                control.manager.configured = partial(self.parameters.configured, plan.name)
                control.manager.default_strictness = partial(self.parameters.strictness, plan.name)
                node = f"{plan.robot.topic_namespace}/controller_manager"
                control.manager.tell = log_of(self.events[ROSOUT], node)
            control.use(physics)
            controls[plan.name] = control
        self.goals.keep(controls.values())  # before the controllers of the others are gone
        for name, control in self.controls.items():
            if controls.get(name) is not control:
                control.retire()
        self.controls = controls
        self.parameters.keep(controls)
        self.commands.use(physics, controls, self.clock)
        self.reactions.use(physics.built)
        self.wrenches.use(physics, (*controls, *physics.built.world_models))
