"""What all controllers share: the command interfaces they claim, and the ports that carry what they write."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf, isnan
from typing import Any, ClassVar, NamedTuple

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import (
    AbstractStateIndex,
    BasicVector,
    Context,
    EventStatus,
    InputPort,
    OutputPort,
    State,
)

from drake_twin.controllers.goal_state import GoalState
from drake_twin.controllers.position_reach import PositionReach
from drake_twin.description.robot_description import RobotDescription
from drake_twin.frozen import Frozen
from drake_twin.saved import saved
from drake_twin.systems.state_layout import StateLayout
from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem


class Interface(NamedTuple):
    """A command or state interface, printed as ros2_control names it: ``joint/velocity``.

    Attributes:
        joint: a joint; for a reference of another controller ``controller/joint``.
        name: ``position``, ``velocity`` or ``effort``.
    """

    joint: str
    name: str

    def __str__(self) -> str:
        return f"{self.joint}/{self.name}"


@dataclass(frozen=True)
class ControllerSetup:
    """What a controller is built from.

    Attributes:
        name: its name; its topics stand below it.
        parameters: an instance of its class's ``Parameters``.
        claims: the command interfaces that it writes while it is active, in order.
        description: the robot: its joints, limits and links.
        layout: where the robot's joints stand in the plant's state ``[q; v]``.
        update_period: the time between two updates (s), a multiple of the physics step.
        update_offset: the time of the first update (s); chained controllers come a physics step after each other.
        namespace: the robot's namespace, ``/robot_1`` or empty.
        frame_prefix: put before its link names in tf messages.
        upstream: the controllers that may write this one's references.
        true_odometry: whether a drive's odometry is the true pose instead of what its wheels tell.
        physics_step: the time between two steps of the physics (s); 0 for one much shorter than ``update_period``.
        position_time_constant: a joint approaches its commanded position at error / this (s).
        tells_of_motion: whether the twin should stop and look when a commanded velocity begins or ceases to be zero.
    """

    name: str
    parameters: Any
    claims: tuple[Interface, ...]
    description: RobotDescription
    layout: StateLayout
    update_period: float = 0.01
    update_offset: float = 0.0
    namespace: str = ""
    frame_prefix: str = ""
    upstream: Mapping[str, "Upstream"] = field(default_factory=dict)
    true_odometry: bool = False
    physics_step: float = 0.0
    position_time_constant: float = 0.2
    tells_of_motion: bool = False


@dataclass(frozen=True)
class Upstream:
    """A controller that may write another one's references.

    Attributes:
        size: the size of its port ``command_interfaces``.
        indices: for each of the other one's references its index in that port; -1 where it does not write it.
    """

    size: int
    indices: tuple[int, ...]


class Controller(WitnesslessSystem):
    """A controller of ros2_control: it reads topics, and writes command interfaces.

    This class is for controllers whose output follows from their input alone, so that Drake's cache computes it once a
    message; those that depend on time or on the robot's state are `PeriodicController`s. A subclass declares its ports
    with the helpers below.

    - ``command_interfaces``: vector, an element for each claim (rad, rad/s, N·m, or m, m/s, N), then one for each of
      ``hints``; NaN where nothing is written.

    Attributes:
        Parameters: a frozen dataclass, read by `drake_twin.description.parameters.read_parameters`.
        setup: what it was built from.
        claims: the command interfaces that it writes.
        hints: what helps the joint servo and is not claimed, such as the velocity that goes with a position.
        subscribed: input topic below the controller's name → ROS message type; each is an abstract input port.
        published: output topic below the controller's name → ROS message type; each is an abstract output port.
        actions: action below the controller's name → ROS action type; each is an abstract input port.
        odometry_frames: the frames that its port ``tf_odometry`` connects, the parent first; None without that port.
        warnings: what of its parameters has no effect.
    """

    Parameters: ClassVar[type]

    @classmethod
    def claimed_interfaces(cls, parameters: Any, description: RobotDescription) -> tuple[Interface, ...]:
        """The command interfaces that a controller with these parameters claims, in order."""
        return ()

    @classmethod
    def reference_interfaces(cls, parameters: Any, description: RobotDescription) -> tuple[Interface, ...]:
        """The references that other controllers may claim of it, without its own name in front."""
        return ()

    def __init__(self, setup: ControllerSetup, hints: Sequence[Interface] = ()):
        super().__init__()
        self.setup = setup
        self.claims = setup.claims
        self.hints = tuple(hints)
        self.subscribed: dict[str, str] = {}
        self.published: dict[str, str] = {}
        self.actions: dict[str, str] = {}
        self.odometry_frames: tuple[str, str] | None = None
        self.warnings: tuple[str, ...] = ()

    def read(self, topic: str, message: Any, context: Context) -> Any:
        """What goes onto a topic's port for a message.

        Args:
            topic: one of ``subscribed`` or ``actions``.
            message: the ROS message; for an action its goal.
            context: the controller's own context at the present time.

        Raises:
            CommandError: the message is refused; its ``deactivates`` tells whether the controller is given up with it.
        """
        return message

    def timeout(self, topic: str) -> float | None:
        """How long a message on a topic holds (s) before the port is cleared again; None for ever."""
        return None

    def starts_or_stops(self, before: Any, now: Any) -> bool:
        """Whether a joint may be driven otherwise when one value on a topic's port follows another; None is none."""
        return True

    def activate(self, context: Context) -> None:
        """Begins anew; whoever calls this has cleared the topics' ports."""

    def deactivate(self, context: Context) -> None:
        """Writes nothing from now on; whoever calls this clears the topics' ports after it."""

    def fault(self, context: Context) -> str | None:
        """Why its last update failed; None if it did not."""
        return None

    def goal_state(self, context: Context) -> GoalState | None:
        """How the present or last goal of its action is getting on; None before the first."""
        return None

    def feedback(self, context: Context) -> Any:
        """The feedback message of its action."""
        return None

    def result(self, context: Context) -> Any:
        """The result message of its action's last goal; None where it holds the goal state's error and no more."""
        return None

    def cancel(self, context: Context) -> None:
        """Ends the present goal of its action."""

    def get_command_interfaces_output_port(self) -> OutputPort:
        """The port ``command_interfaces``."""
        return self.GetOutputPort("command_interfaces")

    def _declare_topic_input(self, topic: str, kind: str) -> InputPort:
        """An input port that carries what `read` made of a topic's last message, None before the first."""
        self.subscribed[topic] = kind
        return self.DeclareAbstractInputPort(topic, AbstractValue.Make(None))

    def _declare_action_input(self, action: str, kind: str) -> InputPort:
        """An input port that carries what `read` made of an action's last goal, None before the first."""
        self.actions[action] = kind
        return self.DeclareAbstractInputPort(action, AbstractValue.Make(None))

    def _declare_topic_output(self, topic: str, kind: str, calc: Any, prerequisites: Collection[Any]) -> OutputPort:
        """An output port that carries a message, or None while there is none; ``calc(context, output)`` sets it."""
        self.published[topic] = kind
        return self.DeclareAbstractOutputPort(topic, lambda: AbstractValue.Make(None), weakly(calc), set(prerequisites))

    def _declare_command_interfaces(self, calc: Any, prerequisites: Collection[Any]) -> OutputPort:
        """The port ``command_interfaces``; ``calc(context, output)`` fills a vector."""
        size = len(self.claims) + len(self.hints)
        return self.DeclareVectorOutputPort("command_interfaces", size, weakly(calc), set(prerequisites))


@saved("Sample")
@dataclass(frozen=True)
class Sample(Frozen):
    """What a periodic controller keeps from one update to the next; its one abstract state.

    Attributes:
        active: whether it is updated.
        time: the time of the last update or of the activation (s).
        memory: the subclass's own frozen value.
        commands: what stands on ``command_interfaces``.
        fault: why the last update failed.
    """

    active: bool = False
    time: float = 0.0
    memory: Any = None
    commands: tuple[float, ...] = ()
    fault: str | None = None


@dataclass(frozen=True)
class Update:
    """What an update returns.

    Attributes:
        memory: the new frozen memory.
        commands: an element for each claim and hint; NaN where nothing is written.
        notice: whether the twin should stop and look, because a goal has come to its end, say.
    """

    memory: Any
    commands: Sequence[float] | np.ndarray
    notice: bool = False


class PeriodicController(Controller):
    """A controller that is updated at its rate, as the controller manager's loop does.

    It samples its inputs at an update and holds its output until the next. What it writes acts in the physics step that
    begins there: Drake makes unrestricted updates before the discrete plant's. Its memory is one frozen value in the
    Context, so that a saved Context is a saved controller. An update that raises makes it write nothing, and ends the
    advance so that it can be deactivated. With ``tells_of_motion`` one that starts or stops a joint ends it, too.

    A position that it writes is no farther from the joint than the joint's servo approaches within the velocity limit;
    `drake_twin.diagram.servo_modes` says what Gazebo does.

    - ``state``: vector ``[q; v]`` of the robot (rad, rad/s, or m, m/s; a floating base first).
    - ``<controller>``, one for each upstream controller: that controller's ``command_interfaces``.
    """

    def __init__(self, setup: ControllerSetup, hints: Sequence[Interface] = ()):
        super().__init__(setup, hints)
        self._nothing = (float("nan"),) * (len(self.claims) + len(self.hints))
        self._reaches = self._position_reaches()
        self._velocities = [
            index
            for index, claim in enumerate(self.claims)
            if setup.tells_of_motion and claim.name == "velocity" and claim.joint in setup.layout.velocities
        ]
        self._state_port = self.DeclareVectorInputPort("state", setup.layout.size)
        self._upstream_ports = {
            name: self.DeclareVectorInputPort(name, upstream.size) for name, upstream in setup.upstream.items()
        }
        self._sample_index: AbstractStateIndex = self.DeclareAbstractState(
            AbstractValue.Make(Sample(commands=self._nothing))
        )
        self._declare_command_interfaces(self._calc_command_interfaces, {self.sample_ticket()})
        self.DeclarePeriodicUnrestrictedUpdateEvent(
            setup.update_period, setup.update_offset, weakly(self._update_sample)
        )

    def start(self, context: Context) -> Any:
        """The memory at activation."""
        return None

    def starts_or_stops(self, before: Any, now: Any) -> bool:
        """No joint is driven otherwise before the next update, which tells of it."""
        return False

    def update(self, context: Context, time: float, memory: Any) -> Update:
        """One update.

        Args:
            context: the controller's own context.
            time: the present time (s); the last update was ``self.sample(context).time``.
            memory: what `start` or the last update left.

        Raises:
            Exception: the controller is deactivated with the exception's text.
        """
        raise NotImplementedError

    def sample(self, context: Context) -> Sample:
        """What the last update left."""
        sample: Sample = context.get_abstract_state(int(self._sample_index)).get_value()
        return sample

    def sample_ticket(self) -> Any:
        """What an output port that follows from the last update depends on."""
        return self.abstract_state_ticket(self._sample_index)

    def get_state_input_port(self) -> InputPort:
        """The port ``state``."""
        return self._state_port

    def get_upstream_input_port(self, controller: str) -> InputPort:
        """The port of a controller that may write this one's references."""
        return self._upstream_ports[controller]

    def activate(self, context: Context) -> None:
        """Begins anew at the present time."""
        sample = Sample(True, context.get_time(), self.start(context), self._nothing)
        context.SetAbstractState(int(self._sample_index), sample)

    def deactivate(self, context: Context) -> None:
        """Writes nothing and is not updated from now on; the memory stays to be looked at."""
        sample = replace(self.sample(context), active=False, commands=self._nothing)
        context.SetAbstractState(int(self._sample_index), sample)

    def fault(self, context: Context) -> str | None:
        """Why its last update failed; None if it did not."""
        return self.sample(context).fault

    def positions(self, context: Context, joints: Sequence[str]) -> np.ndarray:
        """Positions of joints at the present time (rad or m)."""
        state = self._state_port.Eval(context)
        return np.array([state[self.setup.layout.positions[joint]] for joint in joints])

    def velocities(self, context: Context, joints: Sequence[str]) -> np.ndarray:
        """Velocities of joints at the present time (rad/s or m/s)."""
        state = self._state_port.Eval(context)
        return np.array([state[self.setup.layout.velocities[joint]] for joint in joints])

    def references(self, context: Context) -> np.ndarray | None:
        """What upstream controllers write to this one's references, NaN where nothing; None when none writes."""
        for name, upstream in self.setup.upstream.items():
            values = np.append(self._upstream_ports[name].Eval(context), np.nan)[list(upstream.indices)]
            if np.isfinite(values).any():
                return np.asarray(values)
        return None

    def _update_sample(self, context: Context, state: State) -> EventStatus:
        sample = self.sample(context)
        if not sample.active or sample.fault is not None:
            return EventStatus.DidNothing()
        time = context.get_time()
        notice = False
        try:
            update = self.update(context, time, sample.memory)
            commands = tuple(map(float, update.commands))
            if self._reaches:
                commands = self._within_reach(context, commands)
            notice = update.notice or (bool(self._velocities) and self._tells_of(sample.commands, commands))
            sample = Sample(True, time, update.memory, commands)
        except Exception as error:  # whatever a controller raises concerns that controller alone
            sample = replace(sample, commands=self._nothing, fault=f"{type(error).__name__}: {error}")
            notice = True
        state.get_mutable_abstract_state(int(self._sample_index)).set_value(sample)
        return EventStatus.ReachedTermination(self, self.setup.name) if notice else EventStatus.Succeeded()

    def _position_reaches(self) -> tuple[PositionReach, ...]:
        """The reach of each position that it writes to a joint with a velocity limit."""
        setup, interfaces = self.setup, (*self.claims, *self.hints)
        reaches = []
        for index, (name, interface) in enumerate(interfaces):
            joint = setup.description.joints_by_name.get(name)  # None for a reference of another controller
            if interface == "position" and joint is not None and 0 < joint.limits.velocity < inf:
                hint = Interface(name, "velocity")
                reaches.append(
                    PositionReach.of_joint(
                        position=index,
                        velocity=interfaces.index(hint) if hint in interfaces else None,
                        joint=setup.layout.positions[name],
                        velocity_limit=joint.limits.velocity,
                        time_constant=setup.position_time_constant,
                        period=setup.update_period,
                    )
                )
        return tuple(reaches)

    def _within_reach(self, context: Context, commands: tuple[float, ...]) -> tuple[float, ...]:
        """The commands with each position within its reach."""
        state, limited = self._state_port.Eval(context).tolist(), list(commands)
        for reach in self._reaches:
            limited[reach.position] = reach.limited(commands, state)
        return tuple(limited)

    def _tells_of(self, before: Sequence[float], now: Sequence[float]) -> bool:
        """Whether a commanded velocity is zero, or none, and was not before; or the other way round."""
        return any(is_motion(before[index]) != is_motion(now[index]) for index in self._velocities)

    def _calc_command_interfaces(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self.sample(context).commands)


def is_motion(velocity: float) -> bool:
    """Whether a commanded velocity, NaN where there is none, moves a joint."""
    return velocity != 0.0 and not isnan(velocity)
