"""A running twin: one simulator, its time, its topics and its state.

Everything happens in the thread that calls `Twin.advance_to` or `Twin.run`, in a fixed order, so that a run is
repeatable to the last bit.
"""

import functools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Concatenate, ParamSpec, Protocol, Self, TypeVar

import numpy as np
from pydrake.geometry import Meshcat
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, Diagram, OutputPort

from drake_twin.controllers.interface import Interface
from drake_twin.description.world_file import WorldFile
from drake_twin.diagram.contact import TouchingShape
from drake_twin.diagram.topics import CommandTopic
from drake_twin.diagram.twin_diagram import Extension
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind, texts
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.messages import shortened
from drake_twin.messages.draft import Draft
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.sensor_plan import SensorPlan
from drake_twin.scenario import LONGEST_TIME, Robot, Scenario
from drake_twin.twin.action import ActionGoal
from drake_twin.twin.alarm import Alarm
from drake_twin.twin.controller_manager import ControllerManager
from drake_twin.twin.edits import copy_model, delete, drag, move, place, pose_joints, push, spawn
from drake_twin.twin.endpoints import Endpoint, MoreTopics, endpoints_of
from drake_twin.twin.entities import EntityState, entity_state
from drake_twin.twin.inbox import Inbox
from drake_twin.twin.real_time import Frames, run_in_real_time
from drake_twin.twin.recording import Recorder, Recording, recorded
from drake_twin.twin.schedule import meeting_step
from drake_twin.twin.sensor_reading import SensorReading
from drake_twin.twin.session import Session
from drake_twin.twin.snapshot import Snapshot
from drake_twin.twin.state import RobotState
from drake_twin.twin.stepper import Stepper
from drake_twin.twin.topics import Topics
from drake_twin.values import is_number

_FASTEST = 1e6  # times real time

_P = ParamSpec("_P")
_R = TypeVar("_R")


class Closable(Protocol):
    """What runs beside a twin."""

    def close(self) -> None:
        """End it."""


def _outside_callbacks(
    what: str,
) -> Callable[[Callable[Concatenate["Twin", _P], _R]], Callable[Concatenate["Twin", _P], _R]]:
    """Decorate a method of `Twin` that callbacks cannot call; a refused call is not recorded."""

    def decorate(method: Callable[Concatenate["Twin", _P], _R]) -> Callable[Concatenate["Twin", _P], _R]:
        @functools.wraps(method)
        def call(self: "Twin", /, *arguments: _P.args, **named: _P.kwargs) -> _R:
            self._stepper.refuse_inside_callback(what)
            return method(self, *arguments, **named)

        return call

    return decorate


class Twin:
    """A scenario, running.

    Args:
        scenario: What to run.
        meshcat: The page to draw on; `draw` and `run` do so.
        plans: Plans of its robots that were made before; the others are made here.
        extensions: Functions that add your own systems to the diagram before it is built, whenever it is built; see
            `drake_twin.diagram.twin_diagram.build_twin_diagram`.

    Attributes:
        recorder: Takes note of what is done to the twin, once `record` has been called.
        inbox: What other threads ask of the twin.
        more_findings: Findings of what runs beside it, such as node programs.
        companions: What runs beside it, and is closed with it.
        more_topics: The topics of its node programs; None without any.

    Raises:
        InputError: If a file or a value of the scenario cannot be used.
    """

    def __init__(
        self,
        scenario: Scenario,
        meshcat: Meshcat | None = None,
        plans: Iterable[RobotPlan] = (),
        extensions: Sequence[Extension] = (),
    ):
        self.recorder = Recorder(lambda: self.time)
        self._session = Session(scenario, meshcat, plans, extensions, self.recorder.note)
        self._topics = Topics(self._session)
        subscriptions = self._session.subscriptions
        subscriptions.read, subscriptions.draft = self._topics.read, self._topics.draft
        self.inbox = Inbox()
        self.more_findings: list[Finding] = []
        self.companions: list[Closable] = []
        self.more_topics: MoreTopics | None = None
        self._stepper = Stepper(self._session, self._topics.publish, self.inbox)
        self._endpoints: tuple[Diagram | None, tuple[Endpoint, ...]] = (None, ())
        self._real_time_rate = 1.0
        self._session.check_commands(self._topics.check)

    @property
    def scenario(self) -> Scenario:
        """What runs."""
        return self._session.scenario

    @property
    def diagram(self) -> Diagram:
        """The Drake diagram; each topic without its leading slash is one of its ports.

        A spawn, a delete, a new step or a restored state may build it again, with its plant and context, and release
        the old one: ask for it again after that.
        """
        return self._session.built.diagram

    @property
    def plant(self) -> MultibodyPlant:
        """The one ``MultibodyPlant``; it lives as long as `diagram`."""
        return self._session.built.plant

    @property
    def context(self) -> Context:
        """The root context at the present time; it lives as long as `diagram`."""
        return self._session.physics.context

    @property
    def time(self) -> float:
        """Simulation time (s)."""
        return self._session.clock.time

    @property
    def step_count(self) -> int:
        """The number of physics steps since the start or the last reset."""
        return self._session.clock.step

    @property
    def time_step(self) -> float:
        """The physics step (s)."""
        return self._session.clock.time_step

    @property
    def alarm(self) -> Alarm:
        """Stops of the simulation for who runs in lock-step with it."""
        return self._session.alarm

    @property
    def paused(self) -> bool:
        """Whether time stands still."""
        return self._stepper.paused

    @paused.setter
    def paused(self, paused: bool) -> None:
        self._stepper.paused = paused

    @property
    def real_time_rate(self) -> float:
        """The simulated seconds that `run` grants per second of wall time.

        Raises:
            InputError: If it is set to a value that is not above zero, or above 1e6.
        """
        return self._real_time_rate

    @real_time_rate.setter
    def real_time_rate(self, rate: float) -> None:
        if not is_number(rate, 0.0) or not 0.0 < rate <= _FASTEST:
            raise InputError(f"{rate!r} is not a real-time rate: it must be above zero and at most {_FASTEST:g}")
        self._real_time_rate = float(rate)

    @property
    def robots(self) -> tuple[str, ...]:
        """The robots' names."""
        return self._session.robots

    @property
    def first_robots(self) -> tuple[str, ...]:
        """The names of the robots that the twin started with; the others have been spawned since."""
        return self._session.first_robots

    @property
    def plans(self) -> tuple[RobotPlan, ...]:
        """What each robot's files amount to."""
        return self._session.built.plans

    @property
    def world_file(self) -> WorldFile | None:
        """What the scenario's world file holds: its models and lights; None without one."""
        return self._session.built.world_file

    @property
    def collision_shapes(self) -> tuple[TouchingShape, ...]:
        """How each collision shape touches: with its faces, in a point, or as a wheel."""
        return self._session.built.shapes

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What became of what the files say, where it is not simply used: mended, ignored, not started, failed …"""
        session = self._session
        sunk = (item for robot in self.robots for item in session.sunk.get(robot, ()))
        faults = (item for control in session.controls.values() for item in control.faults)
        return (*session.built.findings, *sunk, *faults, *session.built.renderer.findings, *self.more_findings)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was ignored or changed to make the robots run, and what they stood in when they came."""
        return texts(self.findings, Kind.WARNING, Kind.MENDED)

    @property
    def not_started(self) -> tuple[str, ...]:
        """What the files ask for and the twin does not start, each with the reason."""
        return texts(self.findings, Kind.NOT_STARTED)

    # Robots ----------------------------------------------------------------------------------------------------------

    @_outside_callbacks("spawn")
    @recorded
    def spawn(self, robot: Robot, *, plan: RobotPlan | None = None) -> None:
        """Add a robot to the world; all others keep their state.

        Args:
            robot: The robot, as a scenario has it. Its controllers are active at once.
            plan: Its plan, if that was made before.

        Raises:
            InputError: If there is one of its name already, or its files cannot be used; nothing is changed then.
        """
        spawn(self._session, robot, plan)

    @_outside_callbacks("delete")
    @recorded
    def delete(self, robot: str) -> None:
        """Remove a robot and its topics, or a model of the world; all others keep their state.

        Args:
            robot: The name of the robot or model.

        Raises:
            InputError: If the robot or model is unknown, or the robot is the last one.
        """
        delete(self._session, robot)

    def robot_state(self, robot: str, *, with_efforts: bool = True) -> RobotState:
        """Return the joints and the true base pose of a robot at the present time.

        Args:
            robot: Its name.
            with_efforts: Whether to compute efforts, for which the plant solves the step to come; else they are zero.

        Raises:
            InputError: If the robot is unknown.
            RunError: If Drake cannot solve that step.
        """
        return self._session.robot_state(robot, with_efforts=with_efforts)

    def state_layout(self, robot: str) -> StateLayout:
        """Return where joints and base stand in `state_vector`; it lives as long as `diagram`.

        Raises:
            InputError: If the robot is unknown.
        """
        return self._session.built.robots[self._session.plan(robot).name].layout

    def state_vector(self, robot: str) -> np.ndarray:
        """Return a robot's positions and velocities ``[q; v]``, as Drake has them: the fastest way to read them.

        Raises:
            InputError: If the robot is unknown.
        """
        return self._session.physics.robot_state(self._session.plan(robot).name)

    def start_positions(self, robot: str) -> Mapping[str, float]:
        """Return the position of each movable joint at the start (rad or m).

        Raises:
            InputError: If the robot is unknown.
        """
        return self._session.plan(robot).start_positions

    @recorded
    def set_joint_positions(self, robot: str, positions: Mapping[str, float]) -> None:
        """Set joint positions at once, without forces; velocities stay.

        Args:
            robot: The robot's name.
            positions: Joint name → position (rad or m).

        Raises:
            InputError: If the robot or a joint is unknown, or a position is not a finite number.
        """
        pose_joints(self._session, robot, positions)

    # Entities --------------------------------------------------------------------------------------------------------

    def entity_state(self, entity: str, reference: str = "world") -> EntityState:
        """Return pose and twist of a robot, a model of the world, or a link (``robot_1::base_link``).

        Args:
            entity: Its name.
            reference: ``world``, or the entity whose frame they are in.

        Raises:
            InputError: If an entity is unknown.
        """
        return entity_state(self._session.built, self._session.physics.plant_context, entity, reference)

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
        """Move a robot or a moving model of the world at once and without forces; what is not given stays.

        Args:
            entity: Its name.
            position: x, y, z of its root link (m).
            orientation: Quaternion w, x, y, z.
            linear: Velocity (m/s).
            angular: Angular velocity (rad/s).
            reference: ``world``, or the entity whose frame all of it is in.

        Raises:
            InputError: If the entity is unknown or cannot be moved, or a value is invalid.
        """
        move(
            self._session,
            entity,
            position=position,
            orientation=orientation,
            linear=linear,
            angular=angular,
            reference=reference,
        )

    @_outside_callbacks("rearrange")
    @recorded
    def place(self, entity: str, xyz: Iterable[float], rpy: Iterable[float] = (0.0, 0.0, 0.0)) -> None:
        """Put a robot or a model of the world elsewhere, at rest; also what is welded to the world or never moves.

        Joints keep their positions, and all others their state.

        Args:
            entity: Its name.
            xyz: The position of its root link, or of a static model, in the world (m).
            rpy: Roll, pitch and yaw (rad).

        Raises:
            InputError: If the entity is unknown or moves on driven joints, or a value is invalid.
        """
        place(self._session, entity, xyz, rpy)

    @_outside_callbacks("rearrange")
    @recorded
    def copy_model(self, model: str, name: str, xyz: Iterable[float], rpy: Iterable[float] = (0.0, 0.0, 0.0)) -> None:
        """Add a model like one of the world.

        Args:
            model: The name of a model of the world.
            name: The name of the new one.
            xyz: Its position in the world (m).
            rpy: Its roll, pitch and yaw (rad).

        Raises:
            InputError: If the model is unknown, the name is taken, or a value is invalid.
        """
        copy_model(self._session, model, name, xyz, rpy)

    @recorded
    def apply_wrench(
        self,
        entity: str,
        force: Iterable[float] = (0.0, 0.0, 0.0),
        torque: Iterable[float] = (0.0, 0.0, 0.0),
        duration: float = 0.0,
        reference: str = "world",
        at: Iterable[float] = (0.0, 0.0, 0.0),
    ) -> None:
        """Push a link for a while; force times duration is the impulse (N·s).

        Args:
            entity: A link, or a robot or model for its root link.
            force: N, in the axes that ``reference`` has now.
            torque: N·m, likewise.
            duration: How long (simulated s); one step at least.
            reference: ``world``, or an entity.
            at: The point of the link at which the force acts, in the link's frame (m).

        Raises:
            InputError: If an entity is unknown, or a value is invalid.
        """
        push(self._session, entity, force, torque, duration, reference, at)

    @recorded
    def drag(
        self,
        entity: str,
        target: Iterable[float],
        at: Iterable[float] = (0.0, 0.0, 0.0),
        duration: float = LONGEST_TIME,
        stiffness: float | None = None,
    ) -> None:
        """Draw a point of a link to a point of the world with a damped spring, in place of the one that draws it now.

        The spring's force follows the motion every 5 ms of simulated time, and is constant in between.

        Args:
            entity: A link, or a robot or model for its root link.
            target: Where to draw it to, in the world (m).
            at: The point of the link, in the link's frame (m).
            duration: How long (simulated s); until `release` by default.
            stiffness: N/m. By default the spring and the robot's or model's whole mass have 10 rad/s, or less where the
                link is so light that this would be unstable. The damping is critical.

        Raises:
            InputError: If the entity is unknown or fixed to the world, or a value is invalid.
        """
        drag(self._session, entity, target, at, duration, stiffness)

    @recorded
    def release(self, entity: str) -> None:
        """End what `drag` began; nothing happens if nothing draws the entity."""
        self._session.wrenches.release(str(entity))

    # Topics and actions ----------------------------------------------------------------------------------------------

    def topics(self) -> dict[str, str]:
        """Return topic → ROS message type: what the twin publishes, then what it listens to."""
        return self._topics.types()

    @property
    def endpoints(self) -> tuple[Endpoint, ...]:
        """The topics out and in and the actions, each with its node, robot and controller.

        The same tuple is returned until a spawn, a delete or a restored state changes them.
        """
        diagram, known = self._endpoints
        if diagram is not self.diagram:
            new = endpoints_of(self._session.built)
            self._endpoints = self.diagram, known if new == known else new
        return self._endpoints[1]

    def actions(self) -> dict[str, str]:
        """Return action → ROS action type."""
        return {action: item.type for action, item in self._session.built.actions.items()}

    @property
    def commanded(self) -> dict[str, CommandTopic]:
        """Command topic → the controller that listens to it."""
        return dict(self._session.built.commanded)

    def command_limits(self, topic: str) -> dict[Interface, tuple[float, float]]:
        """Return the interfaces that a command's numbers drive, in order, with their limits; empty for other messages.

        Raises:
            InputError: If no controller listens to the topic.
        """
        return self._topics.command_limits(topic)

    def command(self, topic: str) -> Any:
        """Return the message last published on a topic; None before the first, and once it has expired.

        Raises:
            InputError: If no controller listens to the topic.
        """
        return self._topics.command(topic)

    @recorded
    def publish(self, topic: str, data: Any) -> None:
        """Publish a command; it takes effect at the next step, also when called inside a callback.

        A controller that is not active does not hear it.

        Args:
            topic: A command topic, for example ``/robot_1/forward_velocity_controller/commands``.
            data: A ROS message, its fields as a mapping, or the bare numbers of a ``Float64MultiArray``.

        Raises:
            InputError: If no controller listens to the topic.
            CommandError: If the message does not fit the topic, an element is not a finite number, or the robot's
                emergency stop holds: nothing is changed then. Or if the size is wrong: the controller is deactivated
                then, as ros2_control does.
        """
        self._topics.publish(topic, data)

    @recorded
    def silence(self, topic: str) -> None:
        """Drop the scenario's own timed commands on a topic until the next reset.

        Raises:
            InputError: If no controller listens to the topic.
        """
        self._session.commands.silenced.add(self._topics.command_topic(topic).topic)

    def subscribe(self, topic: str, callback: Callable[[Any], None], rate: float | None = None) -> Callable[[], None]:
        """Call back with a topic's messages, on a grid of simulation times that starts at zero.

        The message of the present time is delivered first, when the twin next advances. A topic that never changes
        (``/tf_static``, ``robot_description``) is delivered once.

        Args:
            topic: A topic that the twin publishes.
            callback: Is given the message, which it must not change. It may publish, pause, subscribe and read the
                twin; not advance or reset it.
            rate: Messages per second of simulation time; by default the rate at which ROS would publish.

        Returns:
            A function that ends the subscription.

        Raises:
            InputError: If the topic is unknown, or the rate is not above zero.
        """
        return self._topics.subscribe(topic, callback, rate)

    def subscribe_drafts(self, topic: str, callback: Callable[[Draft], None]) -> Callable[[], None]:
        """Call back with drafts of a topic's messages, which any thread may make; otherwise like `subscribe`."""
        return self._topics.subscribe(topic, callback, None, drafts=True)

    def latest(self, topic: str) -> Any:
        """Return a topic's message at the present time; None while its controller is not active or has none.

        Raises:
            InputError: If nothing is published on the topic.
        """
        return self._topics.latest(topic)

    def joint_states(self, robot: str) -> Any:
        """Return the ``sensor_msgs/msg/JointState`` of a robot at the present time.

        Raises:
            InputError: If the robot is unknown.
        """
        return self.latest(f"{self._session.plan(robot).robot.topic_namespace}/joint_states")

    @property
    def sensors(self) -> tuple[tuple[str, SensorPlan], ...]:
        """The sensors that are simulated, each with its robot's name, or with that of its model of the world."""
        built = self._session.built
        of_robots = [(plan.name, item) for plan in built.plans for item in plan.sensors]
        return (*of_robots, *((model.name, item) for model in built.sensing_models for item in model.sensors))

    def sensor(self, robot: str, name: str) -> SensorReading:
        """Return a sensor of a robot: ``twin.sensor("robot_1", "camera").image``, ``.depth``; ``.ranges`` of a lidar.

        Args:
            robot: The robot's name.
            name: The sensor's name in its file.

        Raises:
            InputError: If the robot or the sensor is unknown.
        """
        return SensorReading(self._session, robot, name)

    def evaluate(self, port: OutputPort) -> Any:
        """Return the value of an output port of `diagram` or of its plant, at the present time.

        Raises:
            RunError: If it needs the step to come (efforts, accelerations, contacts), and Drake cannot solve it.
        """
        physics = self._session.physics
        is_plants = port.get_system() is self._session.built.plant
        return self._topics.evaluate(port, physics.plant_context if is_plants else physics.context)

    @recorded
    def send_goal(self, action: str, goal: Any, on_result: Callable[[ActionGoal], None] | None = None) -> ActionGoal:
        """Send a goal to an action; the controller accepts it at its next update.

        Args:
            action: For example ``/robot_1/joint_trajectory_controller/follow_joint_trajectory``.
            goal: The action's goal message, or its fields as a mapping.
            on_result: Called with the goal when it ends, at that very simulation time.

        Raises:
            InputError: If the action is unknown.
            CommandError: If the goal is rejected.
        """
        return self._topics.send_goal(action, goal, on_result)

    def cancel(self, robot: str, controller: str) -> None:
        """Cancel the present goal of a controller's action; the joints hold where they are.

        Raises:
            InputError: If the robot or the controller is unknown.
        """
        self._session.control(robot).cancel(controller)

    # Controllers -----------------------------------------------------------------------------------------------------

    def controller_manager(self, robot: str) -> ControllerManager:
        """Return the controller manager of a robot; its methods are named like the services of ROS 2.

        Raises:
            InputError: If the robot is unknown.
        """
        return self._session.control(robot).manager

    @recorded
    def emergency_stop(self, robot: str) -> None:
        """Brake a robot's joints with all of their effort until they are at rest, and hold them there.

        Goals are cancelled; commands are refused until `clear_emergency_stop`.

        Raises:
            InputError: If the robot is unknown.
        """
        self._session.control(robot).emergency_stop()

    def is_stopped(self, robot: str) -> bool:
        """Return whether a robot's emergency stop holds.

        Raises:
            InputError: If the robot is unknown.
        """
        return self._session.control(robot).stopped

    @recorded
    def clear_emergency_stop(self, robot: str) -> None:
        """Let a robot's controllers command again; each starts without a command.

        Raises:
            InputError: If the robot is unknown.
        """
        self._session.control(robot).clear_emergency_stop()

    # Time ------------------------------------------------------------------------------------------------------------

    def advance_to(self, time: float) -> float:
        """Run until a simulation time (s), as fast as possible.

        Times are met by whole physics steps: the twin stops at the first step that is not before ``time``. It stops
        earlier when a callback pauses it or a node resets it, and does not move while it is paused.

        Returns:
            The simulation time reached (s).

        Raises:
            InputError: If the time is not a finite number, or lies in the past.
            RunError: If a step fails; the twin is in the state before that step then.
        """
        if self.inbox.is_open and not self._stepper.is_advancing:
            self.inbox.work()
        target = self._session.clock.step_at(time)
        if target < self.step_count:
            raise InputError(f"{time:g} s lies in the past: the twin is at {self.time:g} s. Use reset() to start again")
        self._advance(target, float(time))
        return self.time

    def step(self, count: int = 1) -> float:
        """Make physics steps, also while paused.

        Args:
            count: The number of steps.

        Returns:
            The simulation time reached (s).

        Raises:
            InputError: If the count is below one.
            RunError: If a step fails; the twin is in the state before that step then.
        """
        if not isinstance(count, int) or count < 1:
            raise InputError(f"{count!r} steps cannot be made: the number must be at least 1")
        stepper, clock = self._stepper, self._session.clock
        was_paused, stepper.paused = stepper.paused, False
        try:
            self._advance(clock.step + count)
        finally:
            stepper.paused = stepper.paused or was_paused
        return clock.time

    def _advance(self, target: int, time: float | None = None) -> None:
        """Advance to a step, with a stop wherever something has to be done between two advances."""
        stepper, alarm, clock = self._stepper, self._session.alarm, self._session.clock
        stepper.advance(target, time)
        while alarm.requests:
            step = clock.step
            alarm.do_requests()
            if clock.step != step:  # a reset or a restored state
                return
            stepper.advance(target, time)

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
        """Run in real time (times ``real_time_rate``) until a simulation time, or until stopped.

        Args:
            until: The simulation time to end at (s); None for no end.
            each_frame: Called about 30 times a second between steps, also while paused. The run ends when it returns
                False, and continues when it returns anything else, such as None.
            as_fast_as_possible: Ignore ``real_time_rate`` and never wait.

        Raises:
            InputError: If ``until`` is not a finite number.
            RunError: If a step fails; the twin is in the state before that step then.
        """
        if until is not None:
            self._session.clock.step_at(until)  # raises if it is not a time
        run_in_real_time(self, until, each_frame, as_fast_as_possible=as_fast_as_possible)

    def pause(self) -> None:
        """Stop time after the present step."""
        self.paused = True

    def play(self) -> None:
        """Let time continue."""
        self.paused = False

    @recorded
    def set_time_step(self, time_step: float) -> None:
        """Change the physics step; it takes effect at the next multiple of it, and changes no state.

        Args:
            time_step: The new step (s).

        Raises:
            InputError: If the step is not positive or too long, or the present step never meets a multiple of it.
        """
        if not is_number(time_step):
            raise InputError(f"{time_step!r} is not a step: it must be above zero")
        clock = self._session.clock
        new = replace(self.scenario, time_step=float(time_step)).time_step  # raises if it is not a step
        meeting_step(clock.step, clock.time_step, new)
        clock.next_time_step = new
        if not self._stepper.is_advancing:
            self._stepper.change_time_step()

    @_outside_callbacks("reset")
    @recorded
    def reset(self, scenario: Scenario | None = None) -> None:
        """Return to the start: time zero, start positions, no commands, the scenario's commands ahead again.

        Subscriptions stay, and count from zero again. Pending commands are dropped.

        Args:
            scenario: The scenario to start; by default the present one. Where the two differ only in their
                ``values``, ``pushes`` and seed, these are set in the present diagram, unless values retune servos or
                the seed draws noise; else it is built again. The state is the same.

        Raises:
            InputError: If called inside a callback, or the scenario cannot be built; nothing is changed then.
        """
        self._session.reset(scenario, self._topics.check)

    @_outside_callbacks("change")
    @recorded
    def set_values(self, values: Mapping[str, float]) -> None:
        """Set parameters of the plant at once, as the scenario would with these ``values`` beside its own.

        `reset` takes them back; all other parameters become the scenario's. Servo gains stay as they are.

        Args:
            values: Name → value, as in `Scenario`.

        Raises:
            InputError: If a value is unknown or invalid; nothing is changed then.
        """
        self._session.physics.set_values({**self.scenario.values, **values})

    @_outside_callbacks("close")
    def close(self) -> None:
        """Free the memory of the twin's diagram; neither can be used afterwards, nor a plant or context of it.

        pydrake never frees a diagram by itself (drake#22515). A program that makes many twins closes each; ``with
        Twin(scenario) as twin:`` does so at the end. Another call does nothing.

        Raises:
            InputError: If called inside a callback.
        """
        while self.companions:
            self.companions.pop().close()
        if not self._session.physics.is_discarded:
            self._session.built.renderer.close()
            self._session.physics.discard()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def draw(self) -> None:
        """Draw the present state on the page, if there is one."""
        visualizer = self._session.built.visualizer
        if visualizer is not None:
            visualizer.ForcedPublish(visualizer.GetMyContextFromRoot(self.context))

    # State -----------------------------------------------------------------------------------------------------------

    def snapshot(self) -> Snapshot:
        """Return the twin at this moment; `restore` returns to it, in this process or another.

        Goals continue inside their controllers, but nothing is called back at their end.

        Raises:
            InputError: If called inside a callback.
        """
        self._stepper.refuse_inside_callback("take a snapshot of")
        return self._session.snapshot()

    @_outside_callbacks("restore")
    @recorded
    def restore(self, snapshot: Snapshot) -> None:
        """Return to a moment: robots, time, states, controllers and commands are as they were then.

        Subscriptions stay. Pending commands are dropped.

        Raises:
            InputError: If the snapshot cannot be used, or if called inside a callback.
        """
        if not isinstance(snapshot, Snapshot):
            raise InputError(f"{shortened(snapshot)} is not a Snapshot: take one with snapshot(), or Snapshot.load()")
        self._session.restore(snapshot)

    def state_sha256(self) -> str:
        """Return a hash of all that a `snapshot` holds, without the scenario's text.

        Two runs of a scenario with the same hash are in the same state to the last bit, and continue alike. On one
        machine and with one version of drake_twin, a scenario has the same hash in each run, on each supported Python
        and version of NumPy. Another kind of processor or operating system may round otherwise, and another version of
        Drake may simulate otherwise. Of what is
        changed with Drake's own means, a plant's parameters, locked joints and shapes' materials count; other shapes,
        collision filters and values fixed on ports do not, and `restore` does not undo them.
        """
        return self._session.state_sha256()

    def record(self) -> None:
        """Start a recording at this moment; `recording` returns what has been recorded.

        Raises:
            InputError: If called inside a callback.
        """
        self.recorder.begin(self.snapshot())

    def recording(self) -> Recording:
        """Return what has been done since `record`: it can be saved, and replayed to the same state.

        Raises:
            InputError: If `record` has not been called.
        """
        return self.recorder.recording()
