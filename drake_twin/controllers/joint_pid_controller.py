"""The joint controllers of gz-sim whose PID has an integral part."""

from dataclasses import dataclass, field
from typing import Any, ClassVar

from pydrake.systems.framework import Context, InputPort

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.forward_command_controller import numbers_of_claims
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.periodic_controller import PeriodicController, Update
from drake_twin.controllers.position_reach import PositionReach
from drake_twin.controllers.registry import controller
from drake_twin.description.gazebo_drive import JOINT_PID
from drake_twin.description.robot_description import RobotDescription
from drake_twin.frozen import Frozen
from drake_twin.saved import saved


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
class JointPidController(PeriodicController):
    """Command joints, and add the integral part of a PID to the efforts of their servos.

    The proportional and derivative parts are the servo's own, in the plant. The integral part is that of gz-math's
    ``PID::Update`` at this controller's rate: the error is the measured value minus the command, the term is clamped
    after each update, and is subtracted. Each joint has an integral of its own, where gz-sim's JointController uses
    that of its first joint for all.

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
        super().__init__(setup, [Interface(joint, "effort") for joint in setup.parameters.joints])
        self._commands = self.declare_topic_input("commands", "std_msgs/msg/Float64MultiArray")
        layout, joints = setup.layout, setup.parameters.joints
        places = layout.positions if setup.parameters.interface == "position" else layout.velocities
        self._measured = [places[joint] for joint in joints]

    def get_commands_input_port(self) -> InputPort:
        """Return the port ``commands``."""
        return self._commands

    def read(self, topic: str, message: Any, context: Context) -> messages.Numbers:
        """Convert a message to numbers, one for each joint.

        Raises:
            CommandError: If the number of elements is wrong, or an element is not finite.
        """
        return numbers_of_claims(message, self.claims)

    def start(self, context: Context) -> JointPidMemory:
        """Return integral terms of zero."""
        return JointPidMemory((0.0,) * len(self.claims))

    def update(self, context: Context, time: float, memory: JointPidMemory) -> Update:
        """Integrate the errors since the last update."""
        commands = self.received(self._commands, context)
        if commands is None:
            return Update(memory, self._nothing)
        parameters, before = self.setup.parameters, self.sample(context)
        weight = parameters.i_gain * (time - before.time)
        state = self._state_port.Eval(context)
        errors = [float(state[index]) - command for index, command in zip(self._measured, commands.data, strict=True)]
        integrals = [term + weight * error for term, error in zip(memory.integrals, errors, strict=True)]
        if parameters.i_max >= parameters.i_min:
            integrals = [min(max(term, parameters.i_min), parameters.i_max) for term in integrals]
        efforts = [parameters.cmd_offset - term for term in integrals]
        is_new = parameters.interface == "position" and before.commands[: len(efforts)] != commands.data
        return Update(JointPidMemory(tuple(integrals)), [*commands.data, *efforts], notice=is_new)

    def _position_reaches(self) -> tuple[PositionReach, ...]:
        """Return nothing: the servo is a PD, which no position is too far for."""
        return ()
