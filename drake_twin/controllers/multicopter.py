"""A multicopter's rotors and the control of its velocity, as gz-sim's systems for multicopters have them."""

from collections.abc import Sequence
from dataclasses import replace
from math import exp, fsum
from typing import Any, ClassVar

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RotationMatrix
from pydrake.systems.framework import BasicVector, Context, EventStatus, State

from drake_twin.control.lee_velocity import ControlledRotor, LeeGains, LeeVelocity
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.body_forces import BodyForces, ForceController, RobotBody
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.multicopter_parameters import MulticopterParameters
from drake_twin.controllers.periodic_controller import is_motion
from drake_twin.controllers.registry import controller
from drake_twin.controllers.rotor_forces import RotorForces
from drake_twin.controllers.stateful_controller import Sample, StatefulController
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import ACTUATORS, MULTICOPTER
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import CommandError, InputError
from drake_twin.frozen import Frozen
from drake_twin.saved import saved
from drake_twin.systems.weak_callback import weakly


@saved("RotorSpeeds")
@dataclass(frozen=True)
class RotorSpeeds(Frozen):
    """Speeds that the rotors approach, each with its lag.

    Attributes:
        time: Since when (s).
        starts: The speeds at that time (rad/s).
        targets: The speeds that they approach (rad/s).
    """

    time: float
    starts: tuple[float, ...]
    targets: tuple[float, ...]


@saved("VelocityCommand")
@dataclass(frozen=True)
class VelocityCommand(Frozen):
    """A velocity in the body's axes, or whether to follow velocities.

    Attributes:
        time: When it came (s).
        linear: The linear velocity (m/s).
        angular: The angular velocity (rad/s).
        enable: Whether to follow velocities.
    """

    time: float
    linear: tuple[float, ...] = (0.0, 0.0, 0.0)
    angular: tuple[float, ...] = (0.0, 0.0, 0.0)
    enable: bool = True


@controller(MULTICOPTER)
class Multicopter(ForceController, StatefulController):
    """Drive the rotors of a multicopter by their speeds, or by a velocity of its body: ``gz_sim/Multicopter``.

    Behaves as gz-sim's MulticopterMotorModel for all of its rotors, and as its MulticopterVelocityControl where the
    robot has that (from their sources). The speeds follow commands with the lag of each rotor, at any time; the joints
    turn at the speeds ÷ ``rotor_velocity_slowdowns``, with the lag of a speed that rises as that of their servos. The
    control of the velocity is updated up to 250 times a second, where Gazebo does it in each step, and without the
    noise that it can add to what it measures.

    .. pydrake_system::

        name: Multicopter
        input_ports:
        - true_state
        - motor_speed
        - cmd_vel
        - enable
        output_ports:
        - command_interfaces
        - signals

    - ``motor_speed``: ``actuator_msgs/msg/Actuators`` as `RotorSpeeds`; not where the velocity is controlled.
    - ``cmd_vel``, ``enable``: ``geometry_msgs/msg/Twist``, in the body's axes, and ``std_msgs/msg/Bool``, as
      `VelocityCommand`; where the velocity is controlled, from the first ``cmd_vel`` on.
    - ``true_state``: the robot's ``[q; v]``, where the velocity is controlled.
    - ``signals``: for each rotor since when it approaches a speed (s), which, how far it was from that (rad/s), and
      the rate of the approach, which is negative (1/s).
    """

    Parameters: ClassVar[type] = MulticopterParameters
    Forces: ClassVar[type[BodyForces]] = RotorForces
    needs_command_interfaces = False
    flies = True

    @classmethod
    def links(cls, parameters: MulticopterParameters) -> Sequence[str]:
        """Return the rotors' links, and that whose velocity is controlled."""
        return (*parameters.links, *([parameters.com_link] if parameters.controls_velocity else []))

    @classmethod
    def claimed_interfaces(
        cls, parameters: MulticopterParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return the velocity of each rotor."""
        return tuple(Interface(joint, "velocity") for joint in parameters.joints)

    def __init__(self, setup: ControllerSetup):
        parameters: MulticopterParameters = setup.parameters
        count = len(parameters.joints)
        self._still = RotorSpeeds(0.0, (0.0,) * count, (0.0,) * count)
        super().__init__(setup, initial=Sample(memory=self._still))
        self._control: LeeVelocity | None = None
        self._turns = np.array(parameters.turning_directions) / np.array(parameters.rotor_velocity_slowdowns)
        inputs = []
        if parameters.controls_velocity:
            self._state = self.declare_robot_input("true_state", setup.layout.size)
            self._cmd_vel = self.declare_topic_input("cmd_vel", "geometry_msgs/msg/Twist")
            self._enable = self.declare_topic_input("enable", "std_msgs/msg/Bool")
        else:
            self._speeds = self.declare_topic_input("motor_speed", ACTUATORS)
            inputs.append(self.input_port_ticket(self._speeds.get_index()))
        tickets = {self.sample_ticket(), *inputs}
        self.declare_command_interfaces(self._calc_command_interfaces, tickets)
        self.DeclareVectorOutputPort("signals", 4 * count, weakly(self._calc_signals), tickets)

    def attach(self, body: RobotBody) -> None:
        """Note the robot, and prepare the control of its velocity.

        Raises:
            InputError: If its rotors cannot control it.
        """
        super().attach(body)
        if self.setup.parameters.controls_velocity:
            self._control = _control_of(self.setup.parameters, body)

    def read(self, topic: str, message: Any, context: Context) -> RotorSpeeds | VelocityCommand:
        """Return a message with the time at which it came."""
        time, parameters = context.get_time(), self.setup.parameters
        if topic == "enable":
            return VelocityCommand(time, enable=bool(message.data))
        if topic == "cmd_vel":
            linear = (message.linear.x, message.linear.y, message.linear.z)
            angular = (message.angular.x, message.angular.y, message.angular.z)
            if not np.isfinite([*linear, *angular]).all():
                raise CommandError(f"{topic}: a velocity is not finite")
            return VelocityCommand(
                time,
                _clipped(linear, parameters.maximum_linear_velocity),
                _clipped(angular, parameters.maximum_angular_velocity),
            )
        wanted = np.asarray(message.velocity, dtype=float)
        if (most := max(parameters.actuator_numbers)) >= len(wanted):
            raise CommandError(f"{topic}: velocity has {len(wanted)} numbers, and a rotor reads number {most}, from 0")
        if not np.isfinite(wanted).all():
            raise CommandError(f"{topic}: a velocity is not finite")
        targets = np.minimum(wanted[list(parameters.actuator_numbers)], parameters.max_rot_velocities)
        return self._approached(self._now(context), time, targets.tolist())

    def activate(self, context: Context) -> None:
        """Start with rotors that stand still."""
        self.set_sample(context, Sample(True, context.get_time(), self._still, ()))

    def declare_updates(self) -> bool:
        """Declare the updates of the control of the velocity."""
        if self.setup.parameters.controls_velocity:
            period, offset = self.setup.update_period, self.setup.update_offset
            self.DeclarePeriodicUnrestrictedUpdateEvent(period, offset, weakly(self._update))
        return bool(self.setup.parameters.controls_velocity)

    def _now(self, context: Context) -> RotorSpeeds:
        """Return what the rotors approach."""
        if self.setup.parameters.controls_velocity:
            memory: RotorSpeeds = self.sample(context).memory
            return memory
        return self.received(self._speeds, context) or self._still

    def _approached(self, before: RotorSpeeds, time: float, targets: Sequence[float]) -> RotorSpeeds:
        """Return new targets, from the speeds that the rotors have at a time (s)."""
        parameters, starts = self.setup.parameters, []
        for start, target, up, down in zip(
            before.starts, before.targets, parameters.time_constants_up, parameters.time_constants_down, strict=True
        ):
            lag = up if target > start else down
            starts.append(target + (start - target) * exp((before.time - time) / lag))
        return RotorSpeeds(time, tuple(starts), tuple(targets))

    def _update(self, context: Context, state: State) -> EventStatus:
        sample, time = self.sample(context), context.get_time()
        command, switch = self.received(self._cmd_vel, context), self.received(self._enable, context)
        if not sample.active or self._control is None or command is None:
            return EventStatus.DidNothing()
        if switch is not None and (not switch.enable or command.time < switch.time):
            if not any(sample.memory.targets):
                return EventStatus.DidNothing()
            targets = [0.0] * len(sample.memory.targets)
        else:
            pose, velocity = self.setup.layout.base_state(self._state.Eval(context))
            R_WB = RotationMatrix(Quaternion(pose[:4])).matrix()
            rates, linear = R_WB.T @ velocity[:3], np.array(command.linear)
            speeds = self._control.speeds(R_WB, velocity[3:], rates, linear, command.angular[2])
            by_number = speeds.tolist()
            limits = zip(self.setup.parameters.actuator_numbers, self.setup.parameters.max_rot_velocities, strict=True)
            targets = [min(by_number[number], most) for number, most in limits]
        memory = self._approached(sample.memory, time, targets)
        state.get_mutable_abstract_state(int(self._sample_index)).set_value(replace(sample, time=time, memory=memory))
        before = sample.memory.targets
        if self.setup.tells_of_motion and list(map(is_motion, before)) != list(map(is_motion, targets)):
            return EventStatus.ReachedTermination(self, self.setup.name)  # the joint is driven, or braked, from now on
        return EventStatus.Succeeded()

    def _calc_command_interfaces(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._turns * self._now(context).targets)

    def _calc_signals(self, context: Context, output: BasicVector) -> None:
        now = self._now(context) if self.sample(context).active else self._still
        signals, lags = [], self.setup.parameters
        for start, target, up, down in zip(
            now.starts, now.targets, lags.time_constants_up, lags.time_constants_down, strict=True
        ):
            signals += [now.time, target, start - target, -1.0 / (up if target > start else down)]
        output.SetFromVector(signals)


def _clipped(values: Sequence[float], limits: Sequence[float]) -> tuple[float, ...]:
    return tuple(min(max(value, -abs(limit)), abs(limit)) for value, limit in zip(values, limits, strict=True))


def _control_of(parameters: MulticopterParameters, body: RobotBody) -> LeeVelocity:
    plant, center = body.plant, body.link(parameters.com_link)
    links = [plant.get_body(index) for index in plant.GetBodyIndices(body.instance)]
    # gz-sim adds the links' inertias up as if their frames were one.
    context = plant.CreateDefaultContext()
    inertias = [link.CalcSpatialInertiaInBodyFrame(context) for link in links]
    mass = fsum(item.get_mass() for item in inertias)
    inertia = sum((item.CalcRotationalInertia().CopyToFullMatrix3() for item in inertias), np.zeros((3, 3)))
    middle = sum((item.get_mass() / mass * item.get_com() for item in inertias), np.zeros(3))
    inertia -= mass * (middle @ middle * np.eye(3) - np.outer(middle, middle))
    rotors = []
    for joint, force, moment, direction in zip(
        parameters.control_joints,
        parameters.control_force_constants,
        parameters.control_moment_constants,
        parameters.control_directions,
        strict=True,
    ):
        pose = body.pose(body.joint(joint).child_body(), center)
        x, y, _ = pose.translation()
        upright = float(pose.rotation().matrix()[2, 2])
        rotors.append(
            ControlledRotor(float(np.arctan2(y, x)), float(np.hypot(x, y)), force * upright, moment, direction)
        )
    gains = LeeGains(
        parameters.velocity_gain,
        parameters.attitude_gain,
        parameters.angular_rate_gain,
        parameters.maximum_linear_acceleration,
    )
    try:
        return LeeVelocity(rotors, gains, mass, inertia, body.gravity)
    except ValueError as error:
        raise InputError(f"the control of its velocity: {error}") from error
