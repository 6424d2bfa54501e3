"""A running twin: one simulator, its time, its topics and its state.

Everything happens in the thread that calls `Twin.advance_to` or `Twin.run`, in a fixed order, so that a run is
repeatable to the last bit.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Protocol, Self

from pydrake.geometry import Meshcat
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, Diagram

from drake_twin.diagram.twin_diagram import Extension, TwinDiagram
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Findings
from drake_twin.messages import shortened
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.scenario import Scenario
from drake_twin.twin.control import Control
from drake_twin.twin.diagnostics import Diagnostics
from drake_twin.twin.endpoints import MoreTopics
from drake_twin.twin.entities import Entities
from drake_twin.twin.graph import Graph
from drake_twin.twin.group import Group
from drake_twin.twin.inbox import Inbox
from drake_twin.twin.old_names import OldNames
from drake_twin.twin.owner import Owner, any_thread
from drake_twin.twin.real_time import Frames, run_in_real_time
from drake_twin.twin.recording import Recorder, recorded
from drake_twin.twin.sensor_reading import SensorReading
from drake_twin.twin.session import Session
from drake_twin.twin.snapshot import Snapshot
from drake_twin.twin.state import RobotState
from drake_twin.twin.stepper import Stepper
from drake_twin.twin.twin_clock import TwinClock


class Closable(Protocol):
    """What runs beside a twin."""

    def close(self) -> None:
        """End it."""


class Twin(Group, OldNames, path="twin"):
    """A scenario, running.

    Args:
        scenario: What to run.
        meshcat: The page to draw on; `draw` and `run` do so.
        plans: Plans of its robots that were made before; the others are made here.
        extensions: Functions that add your own systems to the diagram before it is built, whenever it is built; see
            `drake_twin.diagram.twin_diagram.build_twin_diagram`.

    Attributes:
        entities: What is in the world: spawn, delete, move, push and drag it.
        control: The robots' controller managers and emergency stops.
        graph: Topics and actions by name, goals, commands.
        clock: The physics step, and the pace of a run.
        recorder: Takes note of what is done to the twin, once ``recorder.begin`` has been called.
        owner: The thread that it belongs to; ``owner.hand_over()`` lets another one use it.
        frames: The frames of `run`; ``frames.callbacks`` lists functions to call at each, about 30 times a second.
        alarm: Stops of the simulation for who runs in lock-step with it.
        inbox: What other threads ask of the twin: ``inbox.ask(function)``.
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
        self.owner = Owner()
        self.recorder = Recorder(self.owner, lambda: self.time, self.snapshot)
        session = Session(scenario, meshcat, plans, extensions, self.recorder.note, self.owner)
        self.inbox, self.frames, self.alarm = Inbox(self.owner), Frames(), session.alarm
        self.more_findings: list[Finding] = []
        self.companions: list[Closable] = []
        self.more_topics: MoreTopics | None = None
        stepper = Stepper(session, lambda topic, data: self.graph.deliver(topic, data), self.inbox)
        parts = session, stepper, self.recorder
        super().__init__(*parts)
        self.entities, self.control = Entities(*parts), Control(*parts)
        self.graph, self.clock = Graph(*parts), TwinClock(*parts)
        self.graph.feed(session.subscriptions)
        self.frames.callbacks.append(session.events.deliver)  # also while paused
        Diagnostics(session, self.clock, self.frames)
        session.check_commands(self.graph.check)

    @property
    @any_thread
    def scenario(self) -> Scenario:
        """What runs."""
        return self._session.scenario

    @property
    def built(self) -> TwinDiagram:
        """The diagram's parts: ``plans`` of the robots, ``world_file``, collision ``shapes``; new when it is built."""
        return self._session.built

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
        return self._session.handed_out()

    @property
    @any_thread
    def time(self) -> float:
        """Simulation time (s)."""
        return self._session.clock.time

    @property
    @any_thread
    def robots(self) -> tuple[str, ...]:
        """The robots' names."""
        return tuple(robot.name for robot in self._session.scenario.robots)

    @property
    def findings(self) -> Findings:
        """What became of what the files say, where it is not simply used: mended, ignored, not started, failed …"""
        session = self._session
        sunk = (item for robot in self.robots for item in session.sunk.get(robot, ()))
        faults = session.faults()
        built = session.built
        return Findings((*built.findings, *sunk, *faults, *built.renderer.findings, *self.more_findings))

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

    # Topics ----------------------------------------------------------------------------------------------------------

    @recorded("publish")
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
        self.graph._deliver(topic, data)

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
        return self.graph.subscribe(topic, callback, rate)

    def latest(self, topic: str) -> Any:
        """Return a topic's message at the present time; None while its controller is not active or has none.

        Raises:
            InputError: If nothing is published on the topic.
        """
        return self.graph.latest(topic)

    def joint_states(self, robot: str) -> Any:
        """Return the ``sensor_msgs/msg/JointState`` of a robot at the present time.

        Raises:
            InputError: If the robot is unknown.
        """
        return self.latest(f"{self._session.plan(robot).robot.topic_namespace}/joint_states")

    def sensor(self, robot: str, name: str) -> SensorReading:
        """Return a sensor of a robot: ``twin.sensor("robot_1", "camera").image``, ``.depth``; ``.ranges`` of a lidar.

        Args:
            robot: The robot's name.
            name: The sensor's name in its file.

        Raises:
            InputError: If the robot or the sensor is unknown.
        """
        return SensorReading(self._session, robot, name)

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
        if target < self._session.clock.step:
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

    def run(
        self,
        until: float | None = None,
        *,
        each_frame: Callable[[], bool | None] = lambda: None,
        as_fast_as_possible: bool = False,
    ) -> None:
        """Run in real time (times ``clock.real_time_rate``) until a simulation time, or until stopped.

        Args:
            until: The simulation time to end at (s); None for no end.
            each_frame: Called about 30 times a second between steps, also while paused. The run ends when it returns
                False, and continues when it returns anything else, such as None.
            as_fast_as_possible: Ignore ``clock.real_time_rate`` and never wait.

        Raises:
            InputError: If ``until`` is not a finite number.
            RunError: If a step fails; the twin is in the state before that step then.
        """
        if until is not None:
            self._session.clock.step_at(until)  # raises if it is not a time
        run_in_real_time(self, until, each_frame, as_fast_as_possible=as_fast_as_possible)

    @any_thread
    def pause(self) -> None:
        """Stop time after the present step."""
        self._stepper.paused = True

    @any_thread
    def play(self) -> None:
        """Let time continue."""
        self._stepper.paused = False

    @recorded("reset", outside_callbacks="reset")
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
        self._session.reset(scenario, self.graph.check)

    def close(self) -> None:
        """Free the memory of the twin's diagram; neither can be used afterwards, nor a plant or context of it.

        pydrake never frees a diagram by itself (drake#22515). A program that makes many twins closes each; ``with
        Twin(scenario) as twin:`` does so at the end. Another call does nothing.

        Raises:
            InputError: If called inside a callback.
        """
        self._stepper.refuse_inside_callback("close")
        while self.companions:
            self.companions.pop().close()
        self._session.events.close()
        if not self._session.physics.is_discarded:
            self._session.built.renderer.close()
            self._session.physics.discard()
        self.inbox.end()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def draw(self) -> None:
        """Draw the present state on the page, if there is one."""
        if (visualizer := self._session.built.visualizer) is not None:
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

    @recorded("restore", outside_callbacks="restore")
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
        machine and with one version of drake_twin, a scenario has one hash, on each supported Python and version of
        NumPy; forces of rotors, air and water have other last bits with NumPy 1 than with 2. Another processor,
        operating system or version of Drake may round otherwise. Of what Drake's own means change, parameters of the
        plant, locked joints and shapes' materials count; other shapes, collision filters and fixed ports do not.
        """
        return self._session.state_sha256()
