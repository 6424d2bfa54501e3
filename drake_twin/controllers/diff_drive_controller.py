"""Differential drive: a base with driven wheels on its left and right side."""

from dataclasses import field, replace
from math import fsum
from typing import Any, ClassVar

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.control.drive_kinematics import DifferentialDrive
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.drive_controller import (
    DriveController,
    DriveMemory,
    check_covariances,
    state_joint,
    twist_message,
)
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.periodic_controller import Update
from drake_twin.controllers.registry import controller
from drake_twin.controllers.speed_limits import LimitsX, LimitsZ, zero_jerk_limits
from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription
from drake_twin.systems.no_message import set_value

_ZEROS = (0.0,) * 6


@dataclass(frozen=True, kw_only=True)
class DiffDriveParameters:
    """Parameters of ``diff_drive_controller/DiffDriveController``.

    Attributes:
        left_wheel_names: The joints of the left wheels, or references of another controller.
        right_wheel_names: The joints of the right wheels, as many.
        wheel_separation: The distance between the left and right wheels (m).
        wheel_radius: The radius of the wheels (m).
        wheel_separation_multiplier: A correction factor of the separation.
        left_wheel_radius_multiplier: A correction factor of the left wheels' radius.
        right_wheel_radius_multiplier: A correction factor of the right wheels' radius.
        tf_frame_prefix_enable: Whether the frames' names get a prefix.
        tf_frame_prefix: The prefix; empty for the namespace.
        odom_frame_id: The frame of the odometry.
        base_frame_id: The frame of the base.
        pose_covariance_diagonal: The diagonal of the covariance of the odometry's pose.
        twist_covariance_diagonal: The diagonal of the covariance of the odometry's twist.
        open_loop: Whether the odometry follows the commands instead of the wheels.
        position_feedback: Whether the odometry uses the wheels' positions instead of their velocities.
        enable_odom_tf: Whether the odometry's transform is published.
        cmd_vel_timeout: The time after which a command expires and the base brakes (s); 0 for never.
        publish_limited_velocity: Whether ``~/cmd_vel_out`` is published.
        velocity_rolling_window_size: The number of velocities that the odometry averages.
        publish_rate: The rate of the odometry (Hz).
        linear: The limits of the forward velocity.
        angular: The limits of the velocity about z.
        use_stamped_vel: A parameter of Humble; false replaces ``~/cmd_vel`` by ``~/cmd_vel_unstamped`` of type
            ``Twist``.
        wheels_per_side: A parameter of Humble.
    """

    left_wheel_names: tuple[str, ...]
    right_wheel_names: tuple[str, ...]
    wheel_separation: float = field(metadata={"above": 0.0})
    wheel_radius: float = field(metadata={"above": 0.0})
    wheel_separation_multiplier: float = field(default=1.0, metadata={"above": 0.0})
    left_wheel_radius_multiplier: float = field(default=1.0, metadata={"above": 0.0})
    right_wheel_radius_multiplier: float = field(default=1.0, metadata={"above": 0.0})
    tf_frame_prefix_enable: bool = True
    tf_frame_prefix: str = ""
    odom_frame_id: str = "odom"
    base_frame_id: str = "base_link"
    pose_covariance_diagonal: tuple[float, ...] = _ZEROS
    twist_covariance_diagonal: tuple[float, ...] = _ZEROS
    open_loop: bool = False
    position_feedback: bool = True
    enable_odom_tf: bool = True
    cmd_vel_timeout: float = field(default=0.5, metadata={"lower": 0.0})
    publish_limited_velocity: bool = False
    velocity_rolling_window_size: int = field(default=10, metadata={"lower": 1})
    publish_rate: float = field(default=50.0, metadata={"above": 0.0})
    linear: LimitsX = field(default_factory=LimitsX)
    angular: LimitsZ = field(default_factory=LimitsZ)
    use_stamped_vel: bool = True
    wheels_per_side: int = field(default=0, metadata={"unsupported": "the number of wheels follows from their names"})

    def __post_init__(self) -> None:
        for name in ("left_wheel_names", "right_wheel_names"):
            if not getattr(self, name):
                raise ParameterError(f"{name} is empty", name)
        left, right = len(self.left_wheel_names), len(self.right_wheel_names)
        if left != right:
            raise ParameterError(
                f"the number of left wheels [{left}] and the number of right wheels [{right}] are different",
                "right_wheel_names",
            )
        check_covariances(self)

    def kinematics(self) -> DifferentialDrive:
        """Return the drive, with the correction factors applied."""
        return DifferentialDrive(
            self.wheel_separation_multiplier * self.wheel_separation,
            self.left_wheel_radius_multiplier * self.wheel_radius,
            self.right_wheel_radius_multiplier * self.wheel_radius,
        )


@controller("diff_drive_controller/DiffDriveController")
class DiffDriveController(DriveController):
    """Drive a base with wheels on two sides at a commanded twist, within its limits, and publish its odometry.

    Behaves as ``diff_drive_controller/DiffDriveController`` does in ROS 2 Jazzy: once a command is older than
    ``cmd_vel_timeout``, the base brakes as its limits allow. Before the first command nothing is written, and zero once
    the time-out has passed since the activation. A command that is not finite is refused, and does not prolong the
    previous one; see also `DriveController`.

    .. pydrake_system::

        name: DiffDriveController
        input_ports:
        - state
        - cmd_vel
        - <upstream controller>
        output_ports:
        - command_interfaces
        - odom
        - tf_odometry
        - cmd_vel_out

    - ``cmd_vel``: ``geometry_msgs/msg/TwistStamped`` (m/s, rad/s), or with ``use_stamped_vel: false``
      ``cmd_vel_unstamped``, ``geometry_msgs/msg/Twist``; topic below the controller's name.
    - ``command_interfaces``: velocities of the left wheels, then of the right ones (rad/s).
    - ``odom``: ``nav_msgs/msg/Odometry`` at ``publish_rate``; None before the first update.
    - ``tf_odometry``: ``tf2_msgs/msg/TFMessage``, the same as a transform, for ``/tf``; with ``enable_odom_tf`` only.
    - ``cmd_vel_out``: ``geometry_msgs/msg/TwistStamped``, the command within its limits; with
      ``publish_limited_velocity`` only.

    References for other controllers: ``linear/velocity`` (m/s) and ``angular/velocity`` (rad/s).
    """

    Parameters: ClassVar[type] = DiffDriveParameters
    halt_value = 0.0

    @classmethod
    def claimed_interfaces(
        cls, parameters: DiffDriveParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return the velocities of the left wheels, then of the right ones."""
        wheels = (*parameters.left_wheel_names, *parameters.right_wheel_names)
        return tuple(Interface(wheel, "velocity") for wheel in wheels)

    @classmethod
    def reference_interfaces(cls, parameters: Any, description: RobotDescription) -> tuple[Interface, ...]:
        """Return the base's velocity as references."""
        return Interface("linear", "velocity"), Interface("angular", "velocity")

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: DiffDriveParameters = setup.parameters
        self._drive = parameters.kinematics()
        self._limiters = (parameters.linear.x.limiter(), parameters.angular.z.limiter())
        self.warnings += tuple(zero_jerk_limits(parameters))
        wheels = (*parameters.left_wheel_names, *parameters.right_wheel_names)
        self._odometry_wheels = tuple(state_joint(wheel, setup.layout.velocities) for wheel in wheels)
        self._declare_command("cmd_vel", stamped=parameters.use_stamped_vel, timeout=parameters.cmd_vel_timeout)
        self._declare_odometry("odom")
        if parameters.publish_limited_velocity:
            self.declare_topic_output(
                "cmd_vel_out", "geometry_msgs/msg/TwistStamped", self._calc_cmd_vel_out, {self.sample_ticket()}
            )

    def update(self, context: Context, time: float, memory: DriveMemory) -> Update:
        """Limit the command, update the odometry and drive the wheels."""
        parameters: DiffDriveParameters = self.setup.parameters
        wanted = self._wanted(context, time, memory)
        limited = None
        if wanted is not None:
            limited = self._limited(wanted, memory)
            memory = replace(memory, last=limited, second_to_last=memory.last)
        linear, angular = limited or (0.0, 0.0)
        memory = self._with_odometry(
            context,
            time,
            replace(memory, limited=limited),
            (linear, angular),
            self._base_velocity,
            from_positions=parameters.position_feedback,
        )
        memory = self._with_publication(memory, time, parameters.publish_rate)
        if limited is None:
            return Update(memory, self.sample(context).commands)
        left, right = self._drive.wheel_velocities(*limited)
        per_side = len(parameters.left_wheel_names)
        return Update(memory, (left,) * per_side + (right,) * per_side)

    def _base_velocity(self, wheels: tuple[float, ...]) -> tuple[float, float]:
        per_side = len(wheels) // 2
        return self._drive.base_velocity(fsum(wheels[:per_side]) / per_side, fsum(wheels[per_side:]) / per_side)

    def _calc_cmd_vel_out(self, context: Context, output: AbstractValue) -> None:
        sample = self.sample(context)
        memory: DriveMemory | None = sample.memory
        if memory is None or memory.limited is None:
            set_value(output, None)
            return
        linear, angular = memory.limited
        output.set_value(
            messages.TwistStamped(header=messages.header(sample.time), twist=twist_message(linear, 0.0, angular))
        )
