"""The joint controllers of gz-sim whose PID has an integral part."""

from dataclasses import field
from math import nan
from typing import ClassVar

from pydrake.systems.framework import BasicVector, Context, EventStatus, State

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.forward_command_controller import NumbersForClaims
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.registry import controller
from drake_twin.controllers.stateful_controller import Sample, StatefulController
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import JOINT_PID
from drake_twin.description.robot_description import RobotDescription
from drake_twin.frozen import Frozen
from drake_twin.saved import saved
from drake_twin.systems.weak_callback import weakly


@dataclass(frozen=True, kw_only=True)
class JointPidParameters:
    """Parameters of ``gz_sim/JointPidController``, named after the elements of gz-sim's joint controllers.

    Attributes:
        joints: The joints.
        interface: ``position`` or ``velocity``.
        i_gain: The integral gain (N·m/(rad s) or N/(m s); of a velocity N·m/rad or N/m).
        i_max: The largest integral term (N·m or N); a value below ``i_min`` means that there are no limits.
        i_min: The smallest one.
        cmd_offset: An effort that is always added (N·m or N).
    """

    joints: tuple[str, ...]
    interface: str = field(metadata={"choices": ("position", "velocity")})
    i_gain: float = 0.0
    i_max: float = 1.0
    i_min: float = -1.0
    cmd_offset: float = 0.0


@saved("JointPidMemory")
@dataclass(frozen=True)
class JointPidMemory(Frozen):
    """The integral term of each joint's PID, with the sign that gz-math gives it (N·m or N)."""

    integrals: tuple[float, ...]


@controller(JOINT_PID)
class JointPidController(NumbersForClaims, StatefulController):
    """Command joints, and add the integral part of a PID to the efforts of their servos.

    The proportional and derivative parts are the servo's own, in the plant. The integral part is that of gz-math's
    ``PID::Update`` at this controller's rate: the error is the measured value minus the command, the term is clamped
    after each update, and is subtracted. Commands act at once, as those of a forward command controller. Each joint has
    an integral of its own, where gz-sim's JointController uses that of its first joint for all.

    .. pydrake_system::

        name: JointPidController
        input_ports:
        - state
        - commands
        output_ports:
        - command_interfaces

    - ``commands``: `messages.Numbers` from ``std_msgs/msg/Float64MultiArray``, one for each joint (rad, rad/s, or m,
      m/s). None before the first message.
    - ``command_interfaces``: the same, then the effort of each joint (N·m or N); NaN before the first message.
    """

    Parameters: ClassVar[type] = JointPidParameters

    @classmethod
    def claimed_interfaces(cls, parameters: JointPidParameters, description: RobotDescription) -> tuple[Interface, ...]:
        """Return the interface of each joint."""
        return tuple(Interface(joint, parameters.interface) for joint in parameters.joints)

    def __init__(self, setup: ControllerSetup):
        parameters, layout = setup.parameters, setup.layout
        efforts = tuple(Interface(joint, "effort") for joint in parameters.joints)
        super().__init__(setup, efforts, Sample(memory=self._no_integral(setup)))
        self.has_positions = parameters.interface == "position"
        places = layout.positions if parameters.interface == "position" else layout.velocities
        self._measured = [places[joint] for joint in parameters.joints]
        self._state_port = self.declare_robot_input("state", layout.size)
        self._commands = self.declare_topic_input("commands", "std_msgs/msg/Float64MultiArray")
        tickets = {self.input_port_ticket(self._commands.get_index()), self.sample_ticket()}
        self.declare_command_interfaces(self._calc_command_interfaces, tickets)

    def activate(self, context: Context) -> None:
        """Start with integral terms of zero."""
        self.set_sample(context, Sample(True, context.get_time(), self._no_integral(self.setup)))

    def declare_updates(self) -> bool:
        """Declare the updates of an integral part."""
        setup = self.setup
        if setup.parameters.i_gain:
            self.DeclarePeriodicUnrestrictedUpdateEvent(setup.update_period, setup.update_offset, weakly(self._update))
        return bool(setup.parameters.i_gain)

    @staticmethod
    def _no_integral(setup: ControllerSetup) -> JointPidMemory:
        return JointPidMemory((0.0,) * len(setup.parameters.joints))

    def _update(self, context: Context, state: State) -> EventStatus:
        """Integrate the errors since the last update, or since the first command."""
        sample, commands = self.sample(context), self.received(self._commands, context)
        if not sample.active or commands is None:
            return EventStatus.DidNothing()
        parameters, time = self.setup.parameters, context.get_time()
        weight = parameters.i_gain * min(time - sample.time, self.setup.update_period)
        measured = self._state_port.Eval(context)
        errors = [measured[index] - command for index, command in zip(self._measured, commands.data, strict=True)]
        terms = [float(term + weight * error) for term, error in zip(sample.memory.integrals, errors, strict=True)]
        if parameters.i_max >= parameters.i_min:
            terms = [min(max(term, parameters.i_min), parameters.i_max) for term in terms]
        new = Sample(True, time, JointPidMemory(tuple(terms)))
        state.get_mutable_abstract_state(int(self._sample_index)).set_value(new)
        return EventStatus.Succeeded()

    def _calc_command_interfaces(self, context: Context, output: BasicVector) -> None:
        commands, offset = self.received(self._commands, context), self.setup.parameters.cmd_offset
        if commands is None:
            output.SetFromVector([nan] * len(self.interfaces))
        else:
            efforts = [offset - term for term in self.sample(context).memory.integrals]
            output.SetFromVector([*commands.data, *efforts])
