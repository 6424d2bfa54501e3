"""The base of controllers that are updated at their own rate, as in the controller manager's loop."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf, isnan
from typing import Any

import numpy as np
from pydrake.systems.framework import BasicVector, Context, EventStatus, InputPort, State

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.position_reach import PositionReach
from drake_twin.controllers.stateful_controller import Sample, StatefulController
from drake_twin.dataclass import dataclass
from drake_twin.errors import TwinError, described
from drake_twin.systems.weak_callback import weakly

TRUE_STATE = "true_state"  # the name of the port of the state without the measurement delay
COMMANDED_MOTION = "commanded_motion"  # the name of the servo's port of this name


@dataclass(frozen=True)
class Update:
    """The result of an update.

    Attributes:
        memory: The new frozen memory.
        commands: One element for each of `Controller.interfaces`; NaN where nothing is written.
        notice: Whether to end the advance at this step, for example because a goal has ended.
    """

    memory: Any
    commands: Sequence[float] | np.ndarray
    notice: bool = False


class PeriodicController(StatefulController):
    """Update at a rate.

    The controller samples its inputs at an update and holds its output until the next. Its output acts in the physics
    step that starts at the update: Drake makes unrestricted updates before the discrete plant's. Its memory is one
    frozen value in the Context. After an update that raises, it writes nothing, and the advance ends so that the
    controller can be deactivated. With ``tells_of_motion`` an update that starts or stops a joint ends the advance as
    well.

    A commanded position is not farther from the joint than the joint's servo approaches within the velocity limit;
    `drake_twin.twin.servo_modes` describes what Gazebo does.

    - ``state``: vector ``[q; v]`` of the robot (rad, rad/s, or m, m/s; a floating base first).
    - ``true_state``: the same without the robot's measurement delay, for the velocity limits of its servos; only where
      there is a delay.
    - ``<controller>``, one for each upstream controller: that controller's ``command_interfaces``.

    Attributes:
        halt_value: What it leaves on its joints' interfaces when it is deactivated; NaN for nothing.
    """

    halt_value: float = float("nan")

    def __init__(self, setup: ControllerSetup, feedforward: Sequence[Interface] = ()):
        self._nothing = (float("nan"),) * (len(setup.claims) + len(feedforward))
        own = (self.halt_value if claim.joint in setup.layout.velocities else float("nan") for claim in setup.claims)
        self._halted = (*own, *self._nothing[len(setup.claims) :])
        super().__init__(setup, tuple(feedforward), Sample(commands=self._nothing))
        self._reaches = self._position_reaches()
        self._velocities = [
            index
            for index, claim in enumerate(self.claims)
            if setup.tells_of_motion and claim.name == "velocity" and claim.joint in setup.layout.velocities
        ]
        self._state_port = self.declare_robot_input("state", setup.layout.size)
        self._true_state_port = self._state_port
        if self._reaches and setup.measures_late:
            self._true_state_port = self.declare_robot_input(TRUE_STATE, setup.layout.size)
        self._upstream_ports = {
            name: self.DeclareVectorInputPort(name, upstream.size) for name, upstream in setup.upstream.items()
        }
        self.declare_command_interfaces(self._calc_command_interfaces, {self.sample_ticket()})

    def declare_updates(self) -> bool:
        """Declare the updates."""
        setup = self.setup
        self.DeclarePeriodicUnrestrictedUpdateEvent(
            setup.update_period, setup.update_offset, weakly(self._update_sample)
        )
        return True

    def start(self, context: Context) -> Any:
        """Return the memory at activation."""
        return None

    def update(self, context: Context, time: float, memory: Any) -> Update:
        """Make one update.

        Args:
            context: The controller's own context.
            time: The present time (s); the last update was at ``self.sample(context).time``.
            memory: What `start` or the last update returned.

        Raises:
            Exception: The controller is deactivated, with the exception's text as the reason.
        """
        return Update(memory, self._nothing)

    def publication(self, topic: str, context: Context) -> Any:
        """Return the time at which the message on a topic's port was published (s): at the last update."""
        return self.sample(context).time

    def used_id(self, memory: Any) -> int:
        """Return the id of the newest command that an update has used, if commands are numbered."""
        return 0

    def pending(self, context: Context, port: InputPort) -> Any:
        """Return the numbered command on a port if no update has used it; else None."""
        command = self.received(port, context)
        return command if command is not None and command.id > self._used_id(context) else None

    def newest_id(self, context: Context, *ports: InputPort) -> int:
        """Return the highest id of the commands that were used or are pending on some ports."""
        pending: list[int] = [command.id for port in ports if (command := self.pending(context, port)) is not None]
        return max((self._used_id(context), *pending))

    def starts_or_stops(self, before: Any, now: Any) -> bool:
        """Return False: an update changes how joints are driven, and ends the advance if it starts or stops one."""
        return False

    def get_state_input_port(self) -> InputPort:
        """Return the port ``state``."""
        return self._state_port

    def get_upstream_input_port(self, controller: str) -> InputPort:
        """Return the port of a controller that may write this controller's references."""
        return self._upstream_ports[controller]

    def activate(self, context: Context) -> None:
        """Start at the present time with the memory that `start` returns."""
        memory, fault = None, None
        try:
            memory = self.start(context)
        except TwinError:
            raise
        except Exception as error:  # the next update ends the advance, and the controller is deactivated
            fault = described(error)
        self.set_sample(context, Sample(True, context.get_time(), memory, self._nothing, fault))

    def deactivate(self, context: Context) -> None:
        """Stop writing and updating; the memory stays readable."""
        self.set_sample(context, replace(self.sample(context), active=False, commands=self._halted))

    def positions(self, context: Context, joints: Sequence[str]) -> np.ndarray:
        """Return the positions of joints at the present time (rad or m)."""
        state = self._state_port.Eval(context)
        return np.array([state[self.setup.layout.positions[joint]] for joint in joints])

    def velocities(self, context: Context, joints: Sequence[str]) -> np.ndarray:
        """Return the velocities of joints at the present time (rad/s or m/s)."""
        state = self._state_port.Eval(context)
        return np.array([state[self.setup.layout.velocities[joint]] for joint in joints])

    def references(self, context: Context) -> np.ndarray | None:
        """Return the references that upstream controllers write, NaN where nothing is written; None if all are."""
        for name, upstream in self.setup.upstream.items():
            values = np.append(self._upstream_ports[name].Eval(context), np.nan)[list(upstream.indices)]
            if np.isfinite(values).any():
                return np.asarray(values)
        return None

    def _used_id(self, context: Context) -> int:
        memory = self.sample(context).memory
        return 0 if memory is None else self.used_id(memory)

    def _update_sample(self, context: Context, state: State) -> EventStatus:
        sample = self.sample(context)
        if not sample.active:
            return EventStatus.DidNothing()
        if sample.fault is not None:
            return EventStatus.ReachedTermination(self, self.setup.name)
        time = context.get_time()
        notice = False
        try:
            update = self.update(context, time, sample.memory)
            commands = tuple(map(float, update.commands))
            if len(commands) != len(self._nothing):
                raise ValueError(f"{len(commands)} commands for {len(self._nothing)} interfaces")
            if self._reaches:
                commands = self._within_reach(context, commands)
            notice = update.notice or (bool(self._velocities) and self._starts_or_stops(sample.commands, commands))
            sample = Sample(True, time, update.memory, commands)
        except Exception as error:  # an error concerns this controller alone
            sample = replace(sample, commands=self._nothing, fault=described(error))
            notice = True
        state.get_mutable_abstract_state(int(self._sample_index)).set_value(sample)
        return EventStatus.ReachedTermination(self, self.setup.name) if notice else EventStatus.Succeeded()

    def _position_reaches(self) -> tuple[PositionReach, ...]:
        """Return the reach of each position that is written to a joint with a velocity limit."""
        setup, interfaces = self.setup, self.interfaces
        reaches = []
        for index, (name, interface) in enumerate(interfaces):
            joint = setup.description.joints_by_name.get(name)  # None for a reference of another controller
            if interface == "position" and joint is not None and 0 < joint.limits.velocity < inf:
                feedforward = Interface(name, "velocity")
                reaches.append(
                    PositionReach.of_joint(
                        position=index,
                        velocity=interfaces.index(feedforward) if feedforward in interfaces else None,
                        joint=setup.layout.positions[name],
                        velocity_limit=joint.limits.velocity,
                        time_constant=setup.position_time_constant,
                        period=setup.update_period,
                    )
                )
        return tuple(reaches)

    def _within_reach(self, context: Context, commands: tuple[float, ...]) -> tuple[float, ...]:
        """Return the commands with each position limited to its reach."""
        state, limited = self._true_state_port.Eval(context).tolist(), list(commands)
        for reach in self._reaches:
            limited[reach.position] = reach.limited(commands, state)
        return tuple(limited)

    def _starts_or_stops(self, before: Sequence[float], now: Sequence[float]) -> bool:
        """Return whether a commanded velocity changes between zero or NaN and nonzero."""
        return any(is_motion(before[index]) != is_motion(now[index]) for index in self._velocities)

    def _calc_command_interfaces(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self.sample(context).commands)


def is_motion(velocity: float) -> bool:
    """Return whether a commanded velocity moves a joint; NaN stands for no command."""
    return velocity != 0.0 and not isnan(velocity)
