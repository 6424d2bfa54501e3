"""A running twin: one simulator, its time, what is published to it and who listens.

Everything happens in the thread that calls `Twin.advance_to` or `Twin.run`, in a fixed order, so that a run is
repeatable to the last bit.
"""

import functools
import logging
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from math import floor, isfinite
from numbers import Real
from threading import get_ident
from typing import Any, Concatenate, ParamSpec, TypeVar

import numpy as np
from pydrake.geometry import Meshcat
from pydrake.systems.analysis import InitializeParams, SimulatorStatus

from drake_twin.controllers.controller import Interface
from drake_twin.diagram.contact import TouchingShape
from drake_twin.diagram.twin_diagram import CommandTopic, PublishedTopic
from drake_twin.errors import CommandError, InputError, RunError, TwinError
from drake_twin.findings import Finding, Kind, texts
from drake_twin.messages import Numbers, float64_multi_array, shortened
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.scenario import CENIC, LONGEST_TIME, Robot, Scenario, ScenarioError
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml
from drake_twin.twin.action import ActionGoal
from drake_twin.twin.commands import Commands
from drake_twin.twin.controller_manager import ControllerManager
from drake_twin.twin.entities import EntityState, Wrench, entity_state, make_wrench, set_entity_state
from drake_twin.twin.failure import failure, is_possible
from drake_twin.twin.plain_data import from_plain, to_plain
from drake_twin.twin.real_time import Frames, run_in_real_time
from drake_twin.twin.recording import Recorder, Recording, recorded
from drake_twin.twin.robot_control import RobotControl
from drake_twin.twin.running import Moment, Running
from drake_twin.twin.schedule import ScheduledCommand, meeting_step, step_at
from drake_twin.twin.snapshot import Snapshot
from drake_twin.twin.state import RobotState, hash_plain, read_robot_state
from drake_twin.twin.subscriptions import Subscription, Subscriptions
from drake_twin.twin.sunk import sunk_robots

_TERMINATED = SimulatorStatus.ReturnReason.kReachedTerminationCondition
_INSTANT = 1e-9  # s; a continuous plant stands still for so long where a discrete one is between two steps
_LONGEST_ADVANCE = 1.0  # s that are simulated at one go, and once more when one of the steps fails
_FASTEST = 1e6  # times real time

# What goes wrong with saved values that are of another kind than they should be.
_UNFIT = (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RuntimeError)

_log = logging.getLogger(__name__)
_P = ParamSpec("_P")
_R = TypeVar("_R")


def _outside_callbacks(
    what: str,
) -> Callable[[Callable[Concatenate["Twin", _P], _R]], Callable[Concatenate["Twin", _P], _R]]:
    """A method of `Twin` that callbacks cannot call; where it is refused for that, it is not recorded."""

    def decorate(method: Callable[Concatenate["Twin", _P], _R]) -> Callable[Concatenate["Twin", _P], _R]:
        @functools.wraps(method)
        def call(self: "Twin", /, *arguments: _P.args, **named: _P.kwargs) -> _R:
            self._refuse_inside_callback(what)
            return method(self, *arguments, **named)

        return call

    return decorate


class Twin:
    """A scenario, running.

    Args:
        scenario: what to run.
        meshcat: the page to draw on; `draw` and `run` do so.

    Attributes:
        scenario: what runs.
        recorder: takes note of what is done to the twin, once `record` has been called.
        paused: whether time stands still.

    Raises:
        InputError: a file or a value of the scenario that cannot be used.
    """

    def __init__(self, scenario: Scenario, meshcat: Meshcat | None = None):
        self.scenario = scenario
        self._meshcat = meshcat
        self._subscriptions = Subscriptions(self._latest, scenario.time_step)
        self._controls: dict[str, RobotControl] = {}
        self._commands = Commands()
        self.recorder = Recorder(lambda: self.time)
        self._run(Running(scenario, meshcat))
        self._goals: list[ActionGoal] = []
        self._unheard: set[str] = set()
        self._sunk: dict[str, tuple[Finding, ...]] = {}
        self.paused = False
        self._advancing: int | None = None  # the thread that does
        self._real_time_rate = 1.0
        self._next_time_step: float | None = None
        self._start()
        self._sunk = sunk_robots(self._built, self._context, self.robots)
        for index, command in enumerate(scenario.commands):
            try:
                self._checked(self._command_topic(command.topic), command.topic, command.data)
            except InputError as error:
                raise ScenarioError(("commands", index), str(error).rstrip(".")) from None

    def _start(self) -> None:
        self._step = 0
        self._running.start_at_rest()
        self._commands.start(self.scenario.commands)
        self._wrenches: list[Wrench] = []
        self._running.set_wrenches(())
        for control in self._controls.values():
            control.start()
        self._running.initialize()

    def _run(self, running: Running) -> None:
        """Goes on with a diagram."""
        self._running = running
        self._built = running.built
        self._simulator = running.simulator
        self._context = running.context
        self._plant_context = running.plant_context
        controls = {}
        for plan in self._built.plans:
            control = self._controls.get(plan.name)
            if control is None or control.plan is not plan:
                control = RobotControl(plan, self._commands.clear, self.recorder.note)
            control.use(self._built, self._context)
            controls[plan.name] = control
        for name, control in self._controls.items():
            if controls.get(name) is not control:
                control.retire()
        self._controls = controls
        self._commands.use(self._built, self._context, controls, self.scenario.time_step)

    def _rebuild(self, scenario: Scenario, step: int | None = None) -> None:
        """Goes on with a diagram of another scenario, with every state that has a place in it.

        Args:
            scenario: the scenario.
            step: the present step, counted in the scenario's steps; None where they are as long as before.
        """
        running, old = Running(scenario, self._meshcat, self._built), self._running
        known = list(self._controls.values())
        self._step = self._step if step is None else step
        running.carry_over(old, self._step)
        kept = [control for control in known if any(control.plan is plan for plan in running.built.plans)]
        for goal in self._goals:
            if not goal.is_of(kept):
                goal.drop()
        self._goals = [goal for goal in self._goals if goal.is_of(kept)]
        self.scenario = scenario
        self._run(running)
        self._subscriptions.use(scenario.time_step)
        for control in self._controls.values():
            if control not in known:
                control.start()
        names = {*self._controls, *self._built.world_models}
        self._wrenches = [item for item in self._wrenches if item.entity.partition("::")[0] in names]
        self._put_wrenches()
        running.initialize()
        old.discard()
        self._subscriptions.look_again()

    @property
    def diagram(self) -> Any:
        """The Drake diagram; each topic without its leading slash is one of its ports.

        A spawn, a delete, a new step or a restored state may build it anew, with its plant and context, and let go of
        the old one: ask for it again after that.
        """
        return self._built.diagram

    @property
    def plant(self) -> Any:
        """The one ``MultibodyPlant``; it lives as long as `diagram`."""
        return self._built.plant

    @property
    def context(self) -> Any:
        """The root context at the present time; it lives as long as `diagram`."""
        return self._context

    @property
    def time(self) -> float:
        """Simulation time (s)."""
        return self._step * self.scenario.time_step

    @property
    def step_count(self) -> int:
        """The number of physics steps since the start or the last reset."""
        return self._step

    @property
    def robots(self) -> tuple[str, ...]:
        """The robots' names."""
        return tuple(plan.name for plan in self._built.plans)

    @property
    def plans(self) -> tuple[RobotPlan, ...]:
        """What each robot's files amount to."""
        return self._built.plans

    @property
    def collision_shapes(self) -> tuple[TouchingShape, ...]:
        """How each collision shape touches: with its faces, in a point, or as a wheel."""
        return self._built.shapes

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was given up or changed to make the robots run, and what they stood in when they came."""
        return texts(self.findings, Kind.WARNING, Kind.MENDED)

    @property
    def not_started(self) -> tuple[str, ...]:
        """What the files ask for and the twin does not start, each with the reason."""
        return texts(self.findings, Kind.NOT_STARTED)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What became of what the files say, where it is not simply used: mended, ignored, not started, warned of."""
        return (*self._built.findings, *(item for robot in self.robots for item in self._sunk.get(robot, ())))

    @_outside_callbacks("spawn")
    @recorded
    def spawn(self, robot: Robot) -> None:
        """Brings a robot into the world; all others go on as they were.

        Args:
            robot: the robot, as a scenario has it. Its controllers are active at once.

        Raises:
            InputError: there is one of its name already, or its files cannot be used; nothing is changed then.
        """
        if not isinstance(robot, Robot):
            raise InputError(f"{shortened(robot)} is no robot: Robot(name, model) is one")
        if any(known.name == robot.name for known in self.scenario.robots):
            raise InputError(f"Entity [{robot.name}] already exists.")
        self._rebuild(replace(self.scenario, robots=(*self.scenario.robots, robot)))
        self._sunk |= {robot.name: ()} | sunk_robots(self._built, self._context, (robot.name,))
        for finding in self._sunk[robot.name]:
            _log.warning("%s", finding)

    @_outside_callbacks("delete")
    @recorded
    def delete(self, robot: str) -> None:
        """Takes a robot out of the world, and its topics with it; all others go on as they were.

        Raises:
            InputError: there is no such robot, or it is the last one.
        """
        if robot not in self.robots:
            raise InputError(f"Entity [{robot}] does not exist.", value=str(robot), valid=self.robots)
        kept = tuple(item for item in self.scenario.robots if item.name != robot)
        if not kept:
            raise InputError(f"Entity [{robot}] is the last one: a twin needs at least one robot.")
        own = {topic for topic, item in self._built.commanded.items() if item.robot == robot}
        commands = tuple(command for command in self.scenario.commands if command.topic not in own)
        self._rebuild(replace(self.scenario, robots=kept, commands=commands))

    def snapshot(self) -> Snapshot:
        """The twin at this moment; `restore` goes back to it, in this process or another.

        Goals on their way go on inside their controllers, but nobody is told of their end.

        Raises:
            InputError: called inside a callback.
        """
        self._refuse_inside_callback("take a snapshot of")
        return self._snapshot()

    def _snapshot(self) -> Snapshot:
        running = self._running
        running.settle()  # somebody may have written another state
        robots = {}
        for name, control in self._controls.items():
            robots[name] = running.snapshot(control.plan) | control.snapshot()
        return Snapshot(
            scenario=scenario_to_yaml(self.scenario),
            time_step=self.time_step,
            step=self._step,
            robots=robots,
            models=running.model_states(),
            parameters=running.parameters(),
            wrenches=to_plain(tuple(self._wrenches)),
            next_time_step=self._next_time_step,
            **self._commands.snapshot(),
        )

    @_outside_callbacks("restore")
    @recorded
    def restore(self, snapshot: Snapshot) -> None:
        """Goes back to a moment: robots, time, states, controllers and commands are as they were then.

        Subscriptions stay. Commands published and not yet applied are dropped.

        Raises:
            InputError: the snapshot cannot be used; or called inside a callback.
        """
        if not isinstance(snapshot, Snapshot):
            raise InputError(f"{shortened(snapshot)} is no snapshot: snapshot() takes one, Snapshot.load() reads one")
        scenario = ScenarioFile(snapshot.scenario, "snapshot").scenario
        if snapshot.time_step != scenario.time_step:
            raise InputError(f"the saved state has steps of {snapshot.time_step} s, and its scenario others")
        for goal in self._goals:
            goal.drop()
        self._goals.clear()
        self._next_time_step = None
        if scenario != self.scenario:
            self._rebuild(scenario)
        self._start()
        try:
            if set(snapshot.robots) != set(self.robots):
                raise ValueError("it has no state of some of them, or one of others")
            self._step = snapshot.step
            self._context.SetTime(self._running.time_of(self._step))
            self._running.set_model_states(snapshot.models)
            self._running.set_parameters(snapshot.parameters)
            for name, saved in snapshot.robots.items():
                self._running.set_robot_state(name, np.array(saved["state"], dtype=float))
                self._controls[name].restore(saved)
            self._commands.restore(snapshot, self.time)
            self._wrenches = list(from_plain(snapshot.wrenches))
            self._put_wrenches()
            if snapshot.next_time_step is not None:
                self._next_time_step = replace(scenario, time_step=snapshot.next_time_step).time_step
                meeting_step(self._step, self.time_step, self._next_time_step)
            if not is_possible(self._built.plant.GetPositionsAndVelocities(self._plant_context)):
                raise ValueError("positions or velocities are not finite")
        except (*_UNFIT, TwinError, SystemExit) as error:  # some of Drake's checks end the process if they can
            self._reset()
            reason = " ".join(str(error).split())
            raise InputError(f"the saved state does not fit the robots that it names ({reason})") from None
        self._running.initialize()
        self._subscriptions.begin(self.time)

    def entity_state(self, entity: str, reference: str = "world") -> EntityState:
        """Pose and twist of a robot, a model of the world, or a link (``robot_1::base_link``).

        Args:
            entity: its name.
            reference: ``world``, or the entity whose frame they are in.

        Raises:
            InputError: there is none of the name.
        """
        return entity_state(self._built, self._plant_context, entity, reference)

    @recorded
    def set_entity_state(
        self,
        entity: str,
        position: Iterable[float] | None = None,
        orientation: Iterable[float] | None = None,
        linear: Iterable[float] | None = None,
        angular: Iterable[float] | None = None,
        reference: str = "world",
    ) -> None:
        """Puts a robot or a moving model of the world somewhere, at once and without forces; what is not given stays.

        Args:
            entity: its name.
            position: x, y, z of its root link (m).
            orientation: quaternion w, x, y, z.
            linear: velocity (m/s).
            angular: angular velocity (rad/s).
            reference: ``world``, or the entity whose frame all of it is in.

        Raises:
            InputError: there is none of the name, it cannot be moved, or a value is none.
        """
        set_entity_state(
            self._built,
            self._plant_context,
            entity,
            position=position,
            orientation=orientation,
            linear=linear,
            angular=angular,
            reference=reference,
        )

    @recorded
    def apply_wrench(
        self,
        entity: str,
        force: Iterable[float] = (0.0, 0.0, 0.0),
        torque: Iterable[float] = (0.0, 0.0, 0.0),
        duration: float = 0.0,
        reference: str = "world",
    ) -> None:
        """Pushes a link at its origin for a while.

        Args:
            entity: a link, or a robot or model for its root link.
            force: N, in the axes that ``reference`` has now.
            torque: N·m, likewise.
            duration: how long (simulated s); one step at least.
            reference: ``world``, or an entity.

        Raises:
            InputError: there is none of the name, or a value is none.
        """
        if not _is_number(duration) or duration < 0:
            raise InputError(f"{duration!r} s is no duration")
        until = min(self.time + max(float(duration), self.time_step), LONGEST_TIME)
        wrench = make_wrench(self._built, self._plant_context, entity, force, torque, until, reference)
        self._wrenches.append(wrench)
        self._put_wrenches()

    def _put_wrenches(self) -> None:
        """Puts the wrenches that act onto the plant's port."""
        self._wrenches = [item for item in self._wrenches if item.until > self.time + 1e-9]
        self._running.set_wrenches(self._wrenches)

    def record(self) -> None:
        """Begins a recording at this moment; `recording` gives what has been recorded.

        Raises:
            InputError: called inside a callback.
        """
        self.recorder.begin(self.snapshot())

    def recording(self) -> Recording:
        """What has been done since `record`: it can be saved, and replayed to the same state.

        Raises:
            InputError: `record` has not been called.
        """
        return self.recorder.recording()

    def cancel(self, robot: str, controller: str) -> None:
        """Ends the present goal of a controller's action; the joints hold where they are.

        Raises:
            InputError: no such robot or controller.
        """
        control = self._controls[self._plan(robot).name]
        if controller not in control.controllers:
            raise InputError(
                f"robot {robot!r} has no controller {controller!r}", value=str(controller), valid=control.controllers
            )
        control.cancel(controller)

    @property
    def time_step(self) -> float:
        """The physics step (s)."""
        return self.scenario.time_step

    @recorded
    def set_time_step(self, time_step: float) -> None:
        """Changes the physics step; it takes effect at the next multiple of it, and changes no state.

        Args:
            time_step: the new step (s).

        Raises:
            InputError: no step that simulates robots, or no multiple of it is ever met by the present one.
        """
        if not _is_number(time_step):
            raise InputError(f"{time_step!r} is not a step: it must be above zero")
        scenario = replace(self.scenario, time_step=float(time_step))  # which refuses what is no step
        meeting_step(self._step, self.time_step, scenario.time_step)
        self._next_time_step = scenario.time_step
        if self._advancing is None:
            self._switch_time_step()

    @property
    def real_time_rate(self) -> float:
        """How many simulated seconds `run` grants a second of wall time.

        Raises:
            InputError: If it is set to a value that is not above zero, or above 1e6.
        """
        return self._real_time_rate

    @real_time_rate.setter
    def real_time_rate(self, rate: float) -> None:
        if not _is_number(rate, 0.0) or not 0.0 < rate <= _FASTEST:
            raise InputError(f"{rate!r} is not a real-time rate: it must be above zero and at most {_FASTEST:g}")
        self._real_time_rate = float(rate)

    def topics(self) -> dict[str, str]:
        """Topic → ROS message type: what the twin publishes, then what it listens to."""
        published = {topic: item.type for topic, item in self._built.published.items()}
        return published | {topic: item.type for topic, item in self._built.commanded.items()}

    def actions(self) -> dict[str, str]:
        """Action → ROS action type."""
        return {action: item.type for action, item in self._built.actions.items()}

    @property
    def commanded(self) -> dict[str, CommandTopic]:
        """Command topic → the controller that listens to it."""
        return dict(self._built.commanded)

    def command_limits(self, topic: str) -> dict[Interface, tuple[float, float]]:
        """What the numbers of a command drive, in their order, and within which limits; empty for other messages.

        Raises:
            InputError: nothing listens to the topic.
        """
        item = self._command_topic(topic)
        if item.type != "std_msgs/msg/Float64MultiArray":
            return {}
        description = self._plan(item.robot).description
        claims = self._controls[item.robot].controllers[item.controller].claims
        free = (-float("inf"), float("inf"))
        return {
            claim: free if "/" in claim.joint else description.limits_of_command(claim.joint, claim.name)
            for claim in claims
        }

    def command(self, topic: str) -> Any:
        """The message last published on a topic; None before the first, and once it no longer holds.

        Raises:
            InputError: nothing listens to the topic.
        """
        self._command_topic(topic)
        waiting = [*self._commands.waiting(topic)]
        value = waiting[-1] if waiting else self._commands.values.get(topic)
        return float64_multi_array(value.data) if isinstance(value, Numbers) else value

    @recorded
    def publish(self, topic: str, data: Any) -> None:
        """Publishes a command; it takes effect at the next step, also when called inside a callback.

        A controller that is not active does not hear it.

        Args:
            topic: a command topic, for example ``/robot_1/forward_velocity_controller/commands``.
            data: a ROS message, its fields as a mapping, or the bare numbers of a ``Float64MultiArray``.

        Raises:
            InputError: nothing listens to the topic.
            CommandError: the message does not fit the topic, or an element is not a finite number: nothing is changed
                then. Or the size is wrong: the controller is deactivated then, as ros2_control does. Or the robot's
                emergency stop holds.
        """
        self._publish(topic, data)

    def _publish(self, topic: str, data: Any) -> None:
        item = self._command_topic(topic)
        control = self._controls[item.robot]
        if control.stopped:
            raise CommandError(f"{topic}: the emergency stop of {item.robot!r} holds: clear_emergency_stop() ends it")
        if not control.accepts(item):
            if topic not in self._unheard:
                self._unheard.add(topic)
                _log.warning("%s: nobody hears this: controller %s is not active", topic, item.controller)
            return
        try:
            value = self._checked(item, topic, data)
        except CommandError as error:
            if error.deactivates:
                control.give_up(item.controller, error.message)
            raise
        self._commands.wait(topic, value)

    @recorded
    def send_goal(self, action: str, goal: Any, on_result: Callable[[ActionGoal], None] | None = None) -> ActionGoal:
        """Sends a goal to an action; it is taken up at the controller's next update.

        Args:
            action: for example ``/robot_1/joint_trajectory_controller/follow_joint_trajectory``.
            goal: the action's goal message, or its fields as a mapping.
            on_result: called with the goal when it is done, at that very simulation time.

        Raises:
            InputError: there is no such action.
            CommandError: the goal is rejected.
        """
        if not isinstance(action, str) or action not in self._built.actions:
            raise InputError(f"there is no action {action!r}", value=str(action), valid=self._built.actions)
        if on_result is not None and not callable(on_result):
            raise InputError(f"{on_result!r} cannot be called with the goal when it is done")
        item = self._built.actions[action]
        control = self._controls[item.robot]
        if control.stopped or not control.accepts(item):
            why = "the emergency stop holds" if control.stopped else f"controller {item.controller} is not active"
            raise CommandError(f"{action}: the goal is rejected: {why}")
        self._commands.put_waiting(self.time, item)
        try:
            value = control.read(item, goal)
        except CommandError as error:
            raise error.about(f"{action}: the goal is rejected") from None
        self._commands.set(
            action, value, self.time
        )  # at once: the controller counts goals, and may be told to cancel this one
        sent = ActionGoal(action, item.type, value.id, control, item.controller, on_result)
        self._goals.append(sent)
        return sent

    def controller_manager(self, robot: str) -> ControllerManager:
        """The controller manager of a robot; its methods are named like the services of ROS 2.

        Raises:
            InputError: no such robot.
        """
        return self._controls[self._plan(robot).name].manager

    @recorded
    def emergency_stop(self, robot: str) -> None:
        """Brakes a robot's joints with all of their effort until they are at rest and holds them there.

        Goals on their way are cancelled; commands are refused until `clear_emergency_stop`.

        Raises:
            InputError: no such robot.
        """
        self._controls[self._plan(robot).name].emergency_stop()

    def is_stopped(self, robot: str) -> bool:
        """Whether a robot's emergency stop holds.

        Raises:
            InputError: no such robot.
        """
        return self._controls[self._plan(robot).name].stopped

    @recorded
    def clear_emergency_stop(self, robot: str) -> None:
        """Lets a robot's controllers command again; each begins anew, without a command.

        Raises:
            InputError: no such robot.
        """
        self._controls[self._plan(robot).name].clear_emergency_stop()

    @recorded
    def silence(self, topic: str) -> None:
        """Drops the scenario's own timed commands on a topic from now on, until the next reset.

        Raises:
            InputError: nothing listens to the topic.
        """
        self._command_topic(topic)
        self._commands.silenced.add(topic)

    def subscribe(self, topic: str, callback: Callable[[Any], None], rate: float | None = None) -> Callable[[], None]:
        """Calls back with a topic's messages, on a grid of simulation times that starts at zero.

        The message of the present time is delivered first, when the twin next advances. A topic that never changes
        (``/tf_static``, ``robot_description``) is delivered once.

        Args:
            topic: a topic that the twin publishes.
            callback: is given the message, which it must not change. It may publish, pause, subscribe and read the
                twin; not advance or reset it.
            rate: messages a second of simulation time; by default what ROS would publish.

        Returns:
            A function that ends the subscription.

        Raises:
            InputError: no such topic, or a rate that is not above zero.
        """
        if not callable(callback):
            raise InputError(f"{callback!r} cannot be called with the messages of {topic!r}")
        if rate is not None and not _is_number(rate, 1e-6):
            raise InputError(f"a rate of {rate!r} Hz is none: it must be a number above zero")
        own_rate = self._published(topic).rate
        rate = own_rate and (rate or own_rate)
        period = None if rate is None else 1.0 / rate
        return self._subscriptions.add(Subscription(topic, callback, period, self.time))

    def latest(self, topic: str) -> Any:
        """A topic's message at the present time; None while its controller is not active or has none.

        Raises:
            InputError: nothing is published on the topic.
        """
        return self._message(self._published(topic))

    def evaluate(self, port: Any) -> Any:
        """The value of an output port of `diagram` or of its plant, at the present time.

        Raises:
            RunError: efforts, accelerations and contacts are those of the step to come, and Drake cannot solve it.
        """
        return self._evaluate(port, self._plant_context if port.get_system() is self._built.plant else self._context)

    def start_positions(self, robot: str) -> Mapping[str, float]:
        """Movable joint → where it stands at the start (rad or m).

        Raises:
            InputError: no such robot.
        """
        positions: Mapping[str, float] = self._plan(robot).start_positions
        return positions

    def joint_states(self, robot: str) -> Any:
        """The ``sensor_msgs/msg/JointState`` of a robot at the present time.

        Raises:
            InputError: no such robot.
        """
        return self.latest(f"{self._plan(robot).robot.topic_namespace}/joint_states")

    def robot_state(self, robot: str, *, with_efforts: bool = True) -> RobotState:
        """The joints and the true base pose of a robot at the present time.

        Args:
            robot: its name.
            with_efforts: whether to ask for efforts, for which the plant solves the step to come; else they are zero.

        Raises:
            InputError: no such robot.
            RunError: Drake cannot solve that step.
        """
        plan = self._plan(robot)
        try:
            return read_robot_state(self._built, self._context, plan, with_efforts=with_efforts)
        except (RuntimeError, SystemExit) as error:
            raise self._failure(error) from error

    @recorded
    def set_joint_positions(self, robot: str, positions: Mapping[str, float]) -> None:
        """Puts joints where they are told to be, at once and without forces; their velocities stay.

        Args:
            robot: the robot's name.
            positions: joint name → position (rad or m).

        Raises:
            InputError: no such robot or joint.
        """
        plan, parts = self._plan(robot), self._built.robots[robot]
        context = self._built.plant.GetMyMutableContextFromRoot(self._context)
        q = self._built.plant.GetPositions(context, parts.instance)
        if not isinstance(positions, Mapping):
            raise InputError(f"{positions!r} is not a mapping of joints to positions")
        for joint, position in positions.items():
            if joint not in plan.start_positions:
                valid = plan.start_positions
                raise InputError(f"robot {plan.name!r} has no movable joint {joint!r}", value=str(joint), valid=valid)
            if not _is_number(position):
                raise InputError(f"position {position!r} of joint {joint!r} is not a finite number")
            q[parts.layout.positions[joint]] = position
        self._built.plant.SetPositions(context, parts.instance, q)
        self._controls[robot].release(positions)

    def advance_to(self, time: float) -> float:
        """Runs until a simulation time (s), as fast as it can.

        Times are met by whole physics steps: the twin stops at the first step that is not before ``time``. It stops
        earlier when a callback pauses it, and does not move while it is paused.

        Returns:
            The simulation time reached (s).

        Raises:
            InputError: the time is not a finite number, or lies in the past.
            RunError: a step fails; the twin is in the state before that step then.
        """
        target = self._step_at(time)
        if target < self._step:
            raise InputError(f"{time:g} s lies in the past: the twin is at {self.time:g} s. Use reset() to start again")
        self._advance(target, float(time))
        return self.time

    def step(self, count: int = 1) -> float:
        """Makes physics steps, also while paused.

        Args:
            count: how many.

        Returns:
            The simulation time reached (s).

        Raises:
            InputError: the count is below one.
            RunError: a step fails; the twin is in the state before that step then.
        """
        if not isinstance(count, int) or count < 1:
            raise InputError(f"{count!r} steps cannot be made: the number must be at least 1")
        was_paused, self.paused = self.paused, False
        try:
            self._advance(self._step + count)
        finally:
            self.paused = self.paused or was_paused
        return self.time

    def pause(self) -> None:
        """Stops time after the step at hand."""
        self.paused = True

    def play(self) -> None:
        """Lets time go on."""
        self.paused = False

    @_outside_callbacks("reset")
    @recorded
    def reset(self) -> None:
        """Goes back to the start: time zero, start positions, no commands, the scenario's commands ahead again.

        Subscriptions stay, and count from zero again. Commands published and not yet applied are dropped.

        Raises:
            InputError: called inside a callback.
        """
        self._reset()

    def _reset(self) -> None:
        for goal in self._goals:
            goal.drop()
        self._goals.clear()
        self._commands.silenced.clear()
        self._start()
        self._subscriptions.begin(0.0)

    def draw(self) -> None:
        """Draws the present state on the page, if there is one."""
        visualizer = self._built.visualizer
        if visualizer is not None:
            visualizer.ForcedPublish(visualizer.GetMyContextFromRoot(self._context))

    @functools.cached_property
    def frames(self) -> Frames:
        """The frames of `run`; ``frames.callbacks`` lists functions to call at each, about 30 times a second."""
        return Frames()

    def run(
        self,
        until: float | None = None,
        *,
        each_frame: Callable[[], bool | None] = lambda: None,
        as_fast_as_possible: bool = False,
    ) -> None:
        """Run in real time (times ``real_time_rate``) until a simulation time, or until ``each_frame`` returns False.

        Args:
            until: The simulation time to end at (s); None for no end.
            each_frame: Called about 30 times a second between steps, also while paused. The run ends when it returns
                False, and continues when it returns anything else, such as None.
            as_fast_as_possible: Whether to ignore ``real_time_rate`` and never wait.

        Raises:
            InputError: If ``until`` is not a finite number.
            RunError: If a step fails; the twin is in the state before that step then.
        """
        if until is not None:
            self._step_at(until)  # raises if it is not a simulation time
        run_in_real_time(self, until, each_frame, as_fast_as_possible=as_fast_as_possible)

    def state_sha256(self) -> str:
        """A hash of all that a `snapshot` holds, but not of the scenario's text.

        Two runs of a scenario with the same hash are in the same state to the last bit, and go on alike. What somebody
        has changed with Drake's own means counts as far as it is a plant's parameter, a locked joint or a shape's
        material; other shapes, collision filters and values fixed on ports do not, and no `restore` undoes them.
        """
        return hash_plain({name: value for name, value in vars(self._snapshot()).items() if name != "scenario"})

    def _steps(self, period: float) -> int:
        """How many steps make up a period (s), one at least."""
        return max(1, round(period / self.scenario.time_step))

    def _step_at(self, time: float) -> int:
        """The first step that is not before a time (s)."""
        if not _is_number(time, -LONGEST_TIME) or time > LONGEST_TIME:
            raise InputError(f"{time!r} is not a simulation time")
        return step_at(time, self.scenario.time_step)

    def _plan(self, robot: str) -> Any:
        for plan in self._built.plans:
            if plan.name == robot:
                return plan
        raise InputError(f"there is no robot {robot!r}", value=str(robot), valid=self.robots)

    def _command_topic(self, topic: str) -> CommandTopic:
        if not isinstance(topic, str) or topic not in self._built.commanded:
            raise InputError(f"nothing listens to {topic!r}", value=str(topic), valid=self._built.commanded)
        return self._built.commanded[topic]

    def _published(self, topic: str) -> PublishedTopic:
        published = self._built.published
        if not isinstance(topic, str) or topic not in published:
            raise InputError(f"nothing is published on {topic!r}", value=str(topic), valid=published)
        return published[topic]

    def _checked(self, item: CommandTopic, topic: str, data: Any) -> Any:
        try:
            return self._controls[item.robot].read(item, data)
        except CommandError as error:
            raise error.about(topic) from None

    def _advance(self, target: int, time: float | None = None) -> None:
        """Advances to a step.

        Args:
            target: the step, in steps of the present length.
            time: where it follows from a time (s), that time: a step of another length may meet it better.
        """
        self._refuse_inside_callback("advance")
        self._advancing = get_ident()
        try:
            self._advance_in_slices(target, target * self.time_step if time is None else time)
            self._switch_time_step()  # whoever stops here meets the step that holds from here on, as a replay does
        finally:
            self._advancing = None

    def _refuse_inside_callback(self, what: str) -> None:
        if self._advancing is None:
            return
        if self._advancing != get_ident():
            raise InputError(f"one thread cannot {what} a twin that another one advances: let it pause or end first")
        raise InputError(f"a callback cannot {what} the twin that calls it: it may publish, pause and subscribe")

    def _advance_in_slices(self, target: int, time: float) -> None:
        while self._step < target and not self.paused:
            self._subscriptions.deliver(self._step)
            if self.paused:
                return
            if self._switch_time_step():
                target = step_at(time, self.scenario.time_step)
                continue
            start, wrenches = self._running.moment(), self._wrenches
            for control in self._controls.values():
                control.kept = None
            self._apply_commands()
            for control in self._controls.values():
                if control.check_period is not None and self._step % self._steps(control.check_period) == 0:
                    control.check_joints()
            # CENIC's steps follow from where it is stopped: always at the same places, whoever listens.
            next_step = self._step + 1 if self.scenario.engine == CENIC else self._next_stop(target)
            try:
                noticed = self._advance_simulator(next_step)
            except (RuntimeError, SystemExit) as error:
                raise self._go_back_from(error, start, next_step, wrenches) from error
            except KeyboardInterrupt:  # somewhere within a step
                self._go_back_to_start(start, wrenches)
                raise
            self._step = round(self._context.get_time() / self.scenario.time_step)
            if noticed:
                for control in self._controls.values():
                    control.give_up_faulty()
                    control.follow_commands()
            if self._goals:
                self._goals = [goal for goal in self._goals if not goal.deliver()]

    def _go_back_from(self, error: BaseException, start: Moment, end: int, wrenches: list[Wrench]) -> RunError:
        """Goes back to the last good state; returns what went wrong after it.

        Args:
            error: what was raised.
            start: the moment from which the simulator was to advance.
            end: the step that it was to advance to.
            wrenches: what pushed links before that.
        """
        if not is_possible(start.state):  # somebody has written it into the context
            return self._failure(error)
        good = before = start
        if end > self._step + 1:  # which of the steps fails, a second try tells
            self._running.go_back(start)
            try:
                for step in range(self._step + 1, end + 1):
                    self._advance_simulator(step)
                    before, good, self._step = good, self._running.moment(), step
            except (RuntimeError, SystemExit) as again:
                error = again
        earlier = None if before is good else before
        found = failure(self._built, self._plant_context, self.time, error, good, earlier)
        if good is start:
            self._go_back_to_start(start, wrenches)
        else:
            self._running.go_back(good)
        return found

    def _go_back_to_start(self, start: Moment, wrenches: list[Wrench]) -> None:
        """Goes back to where an advance began: what was due then is still due."""
        self._wrenches = wrenches
        self._running.set_wrenches(wrenches)
        self._commands.take_back()
        for control in self._controls.values():
            control.take_back()
        self._running.go_back(start)

    def _failure(self, error: BaseException) -> RunError:
        return failure(self._built, self._plant_context, self.time, error)

    def _advance_simulator(self, step: int) -> bool:
        """Advances to a step, or to the first one at which a controller has something to say; whether one has."""
        status = self._simulator.AdvanceTo(self._running.time_of(step))
        noticed = bool(status.reason() == _TERMINATED)
        if noticed:
            self._finish_step()
        if not self._running.settle():
            raise RuntimeError("the state is not made of finite numbers")
        return noticed

    def _finish_step(self) -> None:
        """Goes on to the next step from where a controller has ended an advance."""
        # All that happens at this time has happened, but Drake would do it again when it goes on from here, the plant's
        # step too: so it goes on from between two steps. An update a rounding before its step leaves that step to come.
        now, time_step = self._context.get_time(), self.scenario.time_step
        if self.scenario.engine == CENIC:
            next_step = floor(now / time_step + 1e-6) + 1
            self._context.SetTime(now + _INSTANT)
        else:
            step = round(now / time_step)
            next_step = step + 1
            self._context.SetTime(step * time_step if now < step * time_step else (step + 0.5) * time_step)
        self._simulator.Initialize(InitializeParams(suppress_initialization_events=True))
        self._simulator.AdvanceTo(self._running.time_of(next_step))

    def _switch_time_step(self) -> bool:
        """Takes up the next step length if its time has come; returns whether it has."""
        new = self._next_time_step
        if new is None or meeting_step(self._step, self.time_step, new) != self._step:
            return False
        self._next_time_step = None
        if new != self.scenario.time_step:
            self._rebuild(replace(self.scenario, time_step=new), step_at(self.time, new))
        return True

    def _apply_commands(self) -> None:
        if self._wrenches and any(item.until <= self.time + 1e-9 for item in self._wrenches):
            self._put_wrenches()
        self._commands.apply(self._step, self.time, self._publish_scheduled)

    def _publish_scheduled(self, scheduled: ScheduledCommand) -> None:
        try:
            self._publish(scheduled.topic, scheduled.data)
        except CommandError as error:
            _log.warning("%s", error)

    def _latest(self, topic: str) -> Any:
        item = self._built.published.get(topic)
        return None if item is None else self._message(item)  # its robot may have gone

    def _message(self, item: PublishedTopic) -> Any:
        if item.controller and not self._controls[item.robot].manager.is_active(item.controller):
            return None
        return self._evaluate(item.port, self._context)

    def _evaluate(self, port: Any, context: Any) -> Any:
        try:
            return port.Eval(context)
        except (RuntimeError, SystemExit) as error:
            raise self._failure(error) from error

    def _next_stop(self, target: int) -> int:
        """The next step at which something is due, or the end of the longest advance or the target if that is first."""
        longest = max(1, round(_LONGEST_ADVANCE / self.time_step))
        due = [target, self._step + longest, self._subscriptions.due_step, *self._commands.due_steps()]
        if self._wrenches:
            due += [step_at(item.until, self.scenario.time_step) for item in self._wrenches]
        if self._next_time_step is not None:
            due.append(meeting_step(self._step, self.time_step, self._next_time_step))
        for control in self._controls.values():
            if control.check_period is not None:
                steps = self._steps(control.check_period)
                due.append((self._step // steps + 1) * steps)
        return int(min([step for step in due if step > self._step]))


def _is_number(value: Any, least: float = float("-inf")) -> bool:
    """Whether a value is a finite number, and not below the least."""
    try:
        return isinstance(value, Real) and isfinite(float(value)) and float(value) >= least
    except OverflowError:  # a whole number beyond what a float holds
        return False
