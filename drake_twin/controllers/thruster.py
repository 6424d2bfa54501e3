"""A propeller that pushes a vehicle through water, as gz-sim's Thruster."""

from collections.abc import Sequence
from math import isfinite
from typing import Any, ClassVar

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.tree import PrismaticJoint, RevoluteJoint, RigidBody
from pydrake.systems.framework import BasicVector, Context

from drake_twin import messages
from drake_twin.control.propeller import Propeller
from drake_twin.controllers.base_controller import Controller, ControllerSetup
from drake_twin.controllers.body_forces import BodyForces, ForceController, Motion, RobotBody
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import THRUSTER
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import CommandError
from drake_twin.frozen import Frozen
from drake_twin.kinematics.rotations import rotated
from drake_twin.saved import saved
from drake_twin.systems.no_message import set_value
from drake_twin.systems.weak_callback import weakly

_FLOAT, _BOOL = "std_msgs/msg/Float64", "std_msgs/msg/Bool"


@dataclass(frozen=True, kw_only=True)
class ThrusterParameters:
    """Parameters of ``gz_sim/Thruster``, named after the elements of ``gz-sim-thruster-system``.

    Attributes:
        joint_name: The propeller's joint; thrust is along its axis.
        thrust_coefficient: Thrust ÷ (density · diameter⁴ · speed²); 0 where it follows from the four below.
        alpha_1: That coefficient for a vehicle that stands still.
        alpha_2: What it gains with the velocity of the water ÷ (speed · diameter).
        wake_fraction: How much slower the water at the propeller is than the vehicle, as a part.
        fluid_density: In kg/m³.
        propeller_diameter: In m.
        use_angvel_cmd: Whether commands are speeds of the propeller (rad/s), and not thrusts (N).
        max_thrust_cmd: The largest command.
        min_thrust_cmd: The smallest one.
        deadband: Smaller thrusts do not act (N).
        velocity_control: Whether the propeller turns at once as its thrust needs.
    """

    joint_name: str
    thrust_coefficient: float = 0.0
    alpha_1: float = 1.0
    alpha_2: float = 0.0
    wake_fraction: float = 0.2
    fluid_density: float = 1000.0
    propeller_diameter: float = 0.02
    use_angvel_cmd: bool = False
    max_thrust_cmd: float = 1000.0
    min_thrust_cmd: float = -1000.0
    deadband: float = 0.0
    velocity_control: bool = False

    def __post_init__(self) -> None:
        for name in ("fluid_density", "propeller_diameter"):
            if not 0.0 < getattr(self, name) < np.inf:
                raise ParameterError(f"{name} is {getattr(self, name):g}, and has to be above zero", name)
        if self.thrust_coefficient == 0.0 and self.alpha_1 == 0.0:
            raise ParameterError("alpha_1 is 0, so that nothing is thrust", "alpha_1")
        if self.max_thrust_cmd < self.min_thrust_cmd:
            raise ParameterError("max_thrust_cmd is less than min_thrust_cmd", "max_thrust_cmd")

    @property
    def propeller(self) -> Propeller:
        """The propeller."""
        scale = self.fluid_density * self.propeller_diameter**4
        if self.thrust_coefficient:
            return Propeller(scale, self.thrust_coefficient)
        return Propeller(scale, self.alpha_1, self.alpha_2 * (1.0 - self.wake_fraction) / self.propeller_diameter)


@saved("ThrustCommand")
@dataclass(frozen=True)
class ThrustCommand(Frozen):
    """What a message asks for: a thrust (N), or whether the deadband holds."""

    thrust: float = 0.0
    has_deadband: bool = True


class ThrusterForces(BodyForces):
    """The thrusts of all propellers, along the axes of their joints at the origins of their links."""

    def __init__(self, sources: "Sequence[tuple[ForceController, RobotBody]]"):
        self.bodies: list[RigidBody] = []
        axes = []
        for source, body in sources:
            joint = body.joint(source.setup.parameters.joint_name)
            self.bodies.append(joint.child_body())
            axis = joint.revolute_axis() if isinstance(joint, RevoluteJoint) else _along(joint)
            axes.append(joint.frame_on_child().GetFixedPoseInBodyFrame().rotation().matrix() @ axis)
        self._wrenches = np.hstack([np.zeros((len(axes), 3)), np.array(axes)])

    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the thrust on each propeller's link."""
        thrusts: np.ndarray = signals[:, None] * self._wrenches
        return thrusts


def _along(joint: Any) -> np.ndarray:
    assert isinstance(joint, PrismaticJoint), f"{joint.name()} has no axis"
    axis: np.ndarray = joint.translation_axis()
    return axis


@controller(THRUSTER)
class Thruster(ForceController, Controller):
    """Push with a propeller: by a thrust, or by the thrust of a speed.

    Behaves as gz-sim's Thruster (from its sources): the thrust of a command is there at once, and the propeller turns
    as it needs. Without ``velocity_control`` a proportional controller turns it, whose torque acts on the vehicle, too.

    .. pydrake_system::

        name: Thruster
        input_ports:
        - state
        - cmd_thrust
        - cmd_vel
        - enable_deadband
        output_ports:
        - command_interfaces
        - signals
        - ang_vel
        - force

    - ``state``: the robot's ``[q; v]``.
    - ``cmd_thrust``: ``std_msgs/msg/Float64``, a thrust (N), or with ``use_angvel_cmd`` ``cmd_vel``, a speed (rad/s);
      as `ThrustCommand`.
    - ``enable_deadband``: ``std_msgs/msg/Bool``, whether the deadband holds, likewise.
    - ``ang_vel``: ``std_msgs/msg/Float64``, the speed of the joint, or with ``velocity_control`` the commanded one
      (rad/s); with ``use_angvel_cmd`` ``force`` instead, the thrust (N).
    - ``signals``: the thrust (N).
    """

    Parameters: ClassVar[type] = ThrusterParameters
    Forces: ClassVar[type[BodyForces]] = ThrusterForces
    needs_command_interfaces = False

    @classmethod
    def links(cls, parameters: ThrusterParameters) -> Sequence[str]:
        """Return none: its joint is claimed."""
        return ()

    @classmethod
    def claimed_interfaces(cls, parameters: ThrusterParameters, description: RobotDescription) -> tuple[Interface, ...]:
        """Return the velocity of the propeller."""
        return (Interface(parameters.joint_name, "velocity"),)

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: ThrusterParameters = setup.parameters
        self._propeller = parameters.propeller
        self._arm = np.zeros(3)
        self._state = self.declare_robot_input("state", setup.layout.size)
        self._command = self.declare_topic_input("cmd_vel" if parameters.use_angvel_cmd else "cmd_thrust", _FLOAT)
        self._deadband = self.declare_topic_input("enable_deadband", _BOOL)
        commands = {self.input_port_ticket(port.get_index()) for port in (self._command, self._deadband)}
        state = self.input_port_ticket(self._state.get_index())
        self.declare_command_interfaces(
            self._calc_command_interfaces, {*commands, state} if self._propeller.slope else commands
        )
        self.DeclareVectorOutputPort("signals", 1, weakly(self._calc_signals), commands)
        if parameters.use_angvel_cmd:
            self.declare_topic_output("force", _FLOAT, self._calc_force, commands)
        else:
            self.declare_topic_output("ang_vel", _FLOAT, self._calc_ang_vel, {*commands, state})

    def attach(self, body: RobotBody) -> None:
        """Note the robot, and where its propeller is."""
        super().attach(body)
        bodies = map(body.plant.get_body, body.plant.GetBodyIndices(body.instance))
        base = next((item for item in bodies if item.is_floating_base_body()), None)
        if base is not None:
            self._arm = body.pose(body.joint(self.setup.parameters.joint_name).child_body(), base).translation()

    def read(self, topic: str, message: Any, context: Context) -> ThrustCommand:
        """Return the thrust that a message asks for, within the range of commands."""
        if topic == "enable_deadband":
            return ThrustCommand(has_deadband=bool(message.data))
        parameters, value = self.setup.parameters, float(message.data)
        if not isfinite(value):
            raise CommandError(f"{topic}: {value:g} is not finite")
        value = min(max(value, parameters.min_thrust_cmd), parameters.max_thrust_cmd)
        if not parameters.use_angvel_cmd:
            return ThrustCommand(value)
        return ThrustCommand(self._propeller.thrust(value, self._velocity(context)))

    def _thrust(self, context: Context) -> float:
        command, switch = self.received(self._command, context), self.received(self._deadband, context)
        if command is None:
            return 0.0
        has_deadband = switch is None or switch.has_deadband
        is_less = has_deadband and abs(command.thrust) < self.setup.parameters.deadband
        return 0.0 if is_less else float(command.thrust)

    def _velocity(self, context: Context) -> float:
        """Return how fast the propeller is moved through the world (m/s)."""
        if not self._propeller.slope or self.setup.layout.base_velocity is None:
            return 0.0
        pose, velocity = self.setup.layout.base_state(self._state.Eval(context))
        turning = np.cross(velocity[:3], rotated(pose[None, :4], self._arm[None])[0])
        return float(np.linalg.norm(velocity[3:] + turning))

    def _speed(self, context: Context) -> float:
        return self._propeller.speed(self._thrust(context), self._velocity(context))

    def _calc_command_interfaces(self, context: Context, output: BasicVector) -> None:
        output.SetAtIndex(0, self._speed(context))

    def _calc_signals(self, context: Context, output: BasicVector) -> None:
        output.SetAtIndex(0, self._thrust(context))

    def _calc_force(self, context: Context, output: AbstractValue) -> None:
        set_value(output, messages.message(_FLOAT, {"data": self._thrust(context)}))

    def _calc_ang_vel(self, context: Context, output: AbstractValue) -> None:
        if self.setup.parameters.velocity_control:
            speed = self._speed(context)
        else:
            place = self.setup.layout.velocities[self.setup.parameters.joint_name]
            speed = float(self._state.Eval(context)[place])
        set_value(output, messages.message(_FLOAT, {"data": speed}))
