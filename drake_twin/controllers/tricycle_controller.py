"""A base with one front wheel that is driven and steered."""

from dataclasses import field, replace
from math import cos, nan, pi
from typing import Any, ClassVar

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.control.drive_kinematics import SteeredDrivenWheel
from drake_twin.control.tricycle_limiters import SteeringLimiter, TractionLimiter
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.drive_controller import (
    DriveController,
    DriveMemory,
    check_covariances,
    state_joint,
)
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.periodic_controller import Update
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription
from drake_twin.systems.no_message import set_value

_ZEROS = (0.0,) * 6


@dataclass(frozen=True)
class TractionLimits:
    """Limits of the wheel's speed, each for both directions; NaN for no limit.

    Attributes:
        max_velocity: The highest speed (rad/s).
        min_velocity: The lowest speed (rad/s).
        max_acceleration: The highest acceleration (rad/s²).
        min_acceleration: The lowest acceleration (rad/s²).
        max_deceleration: The highest deceleration (rad/s²).
        min_deceleration: The lowest deceleration (rad/s²).
        max_jerk: The highest jerk (rad/s³).
        min_jerk: The lowest jerk (rad/s³).
    """

    max_velocity: float = nan
    min_velocity: float = nan
    max_acceleration: float = nan
    min_acceleration: float = nan
    max_deceleration: float = nan
    min_deceleration: float = nan
    max_jerk: float = nan
    min_jerk: float = nan

    def __post_init__(self) -> None:
        _checked(self.limiter)

    def limiter(self) -> TractionLimiter:
        """Return the limiter that applies these limits."""
        return TractionLimiter(**vars(self))


@dataclass(frozen=True)
class SteeringLimits:
    """Limits of the steering angle; NaN for no limit.

    Attributes:
        max_position: The highest angle (rad).
        min_position: The lowest angle (rad).
        max_velocity: The highest speed in both directions (rad/s).
        min_velocity: The lowest speed in both directions (rad/s).
        max_acceleration: The highest acceleration in both directions (rad/s²).
        min_acceleration: The lowest acceleration in both directions (rad/s²).
    """

    max_position: float = nan
    min_position: float = nan
    max_velocity: float = nan
    min_velocity: float = nan
    max_acceleration: float = nan
    min_acceleration: float = nan

    def __post_init__(self) -> None:
        _checked(self.limiter)

    def limiter(self) -> SteeringLimiter:
        """Return the limiter that applies these limits."""
        return SteeringLimiter(**vars(self))


def _checked(limiter: Any) -> None:
    try:
        limiter()
    except ValueError as error:
        raise ParameterError(str(error)) from None


@dataclass(frozen=True, kw_only=True)
class TricycleParameters:
    """Parameters of ``tricycle_controller/TricycleController``.

    Attributes:
        traction_joint_name: The joint of the front wheel.
        steering_joint_name: The joint that steers it.
        wheelbase: The distance from the front wheel to the rear axle (m).
        wheel_radius: The radius of the front wheel (m).
        odom_frame_id: The frame of the odometry.
        base_frame_id: The frame of the base.
        pose_covariance_diagonal: The diagonal of the covariance of the odometry's pose.
        twist_covariance_diagonal: The diagonal of the covariance of the odometry's twist.
        open_loop: Whether the odometry follows the commands instead of the joints.
        enable_odom_tf: Whether the odometry's transform is published.
        odom_only_twist: Whether the odometry's pose stays zero.
        cmd_vel_timeout: The time after which a command expires (ms); 0 for never.
        publish_ackermann_command: Whether ``~/cmd_ackermann`` is published.
        velocity_rolling_window_size: The number of velocities that the odometry averages.
        traction: The limits of the wheel's speed.
        steering: The limits of the steering angle.
        use_stamped_vel: A parameter of Humble; false replaces ``~/cmd_vel`` by ``~/cmd_vel_unstamped`` of type
            ``Twist``.
    """

    traction_joint_name: str
    steering_joint_name: str
    wheelbase: float = field(metadata={"above": 0.0})
    wheel_radius: float = field(metadata={"above": 0.0})
    odom_frame_id: str = "odom"
    base_frame_id: str = "base_link"
    pose_covariance_diagonal: tuple[float, ...] = _ZEROS
    twist_covariance_diagonal: tuple[float, ...] = _ZEROS
    open_loop: bool = False
    enable_odom_tf: bool = False
    odom_only_twist: bool = False
    cmd_vel_timeout: int = field(default=500, metadata={"lower": 0})
    publish_ackermann_command: bool = False
    velocity_rolling_window_size: int = field(default=10, metadata={"lower": 1})
    traction: TractionLimits = TractionLimits()
    steering: SteeringLimits = SteeringLimits()
    use_stamped_vel: bool = True

    def __post_init__(self) -> None:
        for name in ("traction_joint_name", "steering_joint_name"):
            if not getattr(self, name):
                raise ParameterError(f"{name} is empty", name)
        check_covariances(self)


@controller("tricycle_controller/TricycleController")
class TricycleController(DriveController):
    """Drive a base with a driven and steered front wheel at a commanded twist, and publish its odometry.

    Behaves as ``tricycle_controller/TricycleController`` does in ROS 2 Jazzy: before the first command and after
    ``cmd_vel_timeout`` the command is zero, approached within the limits. The wheel turns slower while its steering
    error is more than 30°. A command that is not finite is refused, and with a time-out of zero a command is valid for
    ever, as with the other drives.

    .. pydrake_system::

        name: TricycleController
        input_ports:
        - state
        - cmd_vel
        output_ports:
        - command_interfaces
        - odom
        - tf_odometry
        - cmd_ackermann

    - ``cmd_vel``: ``geometry_msgs/msg/TwistStamped`` (m/s forwards, rad/s), or ``cmd_vel_unstamped``,
      ``geometry_msgs/msg/Twist``, with ``use_stamped_vel: false``; topic below the controller's name.
    - ``command_interfaces``: velocity of the wheel (rad/s), position of the steering joint (rad).
    - ``odom``: ``nav_msgs/msg/Odometry`` at every update; None before the first.
    - ``tf_odometry``: ``tf2_msgs/msg/TFMessage``, the same as a transform, for ``/tf``; with ``enable_odom_tf`` only.
    - ``cmd_ackermann``: ``ackermann_msgs/msg/AckermannDrive``, the commands, with ``speed`` in rad/s as upstream; with
      ``publish_ackermann_command`` only.
    """

    Parameters: ClassVar[type] = TricycleParameters
    halt_value = 0.0

    @classmethod
    def claimed_interfaces(cls, parameters: TricycleParameters, description: RobotDescription) -> tuple[Interface, ...]:
        """Return the velocity of the wheel and the position of its steering joint."""
        return (
            Interface(parameters.traction_joint_name, "velocity"),
            Interface(parameters.steering_joint_name, "position"),
        )

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: TricycleParameters = setup.parameters
        self._drive = SteeredDrivenWheel(parameters.wheelbase, parameters.wheel_radius)
        self._limiters = (parameters.traction.limiter(), parameters.steering.limiter())
        self._odometry_wheels = (state_joint(parameters.traction_joint_name, setup.layout.velocities),)
        self._steering_joint = (state_joint(parameters.steering_joint_name, setup.layout.positions),)
        timeout = 1e-3 * parameters.cmd_vel_timeout
        self._declare_command("cmd_vel", stamped=parameters.use_stamped_vel, timeout=timeout)
        self._declare_odometry("odom", with_pose=not parameters.odom_only_twist)
        if parameters.publish_ackermann_command:
            self.declare_topic_output(
                "cmd_ackermann", "ackermann_msgs/msg/AckermannDrive", self._calc_cmd_ackermann, {self.sample_ticket()}
            )

    def update(self, context: Context, time: float, memory: DriveMemory) -> Update:
        """Update the odometry, and drive and steer the wheel."""
        command = self._valid_command(context, time)
        linear, angular = (0.0, 0.0) if command is None else (command.linear_x, command.angular_z)
        (measured,) = map(float, self.positions(context, self._steering_joint))
        memory = self._with_odometry(
            context,
            time,
            memory,
            (linear, angular),
            lambda wheels: self._drive.base_velocity(wheels[0], measured),
            from_positions=False,
        )
        memory = self._with_publication(memory, time)
        speed, angle = self._drive.wheel_command(linear, angular)
        speed *= _share_of_speed(abs(angle - measured))
        limited = self._limited((speed, angle), memory)
        return Update(replace(memory, last=limited, second_to_last=memory.last, limited=limited), limited)

    def _calc_cmd_ackermann(self, context: Context, output: AbstractValue) -> None:
        memory: DriveMemory | None = self.sample(context).memory
        if memory is None or memory.limited is None:
            set_value(output, None)
            return
        speed, angle = memory.limited
        output.set_value(
            messages.AckermannDrive(
                steering_angle=angle, steering_angle_velocity=0.0, speed=speed, acceleration=0.0, jerk=0.0
            )
        )


def _share_of_speed(off: float) -> float:
    """Return the wheel's speed at a steering error (rad), relative to the commanded speed."""
    if off < pi / 6.0:
        return 1.0
    return 0.01 if off > 0.5 * pi else cos(off)
