"""A base with driven wheels on its left and right side."""

from dataclasses import dataclass, field, replace
from math import isfinite
from typing import Any, ClassVar

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.control.drive_kinematics import DifferentialDrive
from drake_twin.controllers.controller import ControllerSetup
from drake_twin.controllers.drive_controller import (
    DriveController,
    DriveMemory,
    check_covariances,
    publication,
    state_joint,
    twist_message,
)
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.periodic_controller import Update
from drake_twin.controllers.registry import controller
from drake_twin.controllers.speed_limits import LimitsX, LimitsZ
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription

_ZEROS = (0.0,) * 6


@dataclass(frozen=True, kw_only=True)
class DiffDriveParameters:
    """Parameters of ``diff_drive_controller/DiffDriveController``.

    Attributes:
        left_wheel_names: the joints of the left wheels; a reference of another controller where one is chained.
        right_wheel_names: those of the right wheels, as many.
        wheel_separation: the distance between the left and right wheels (m).
        wheel_radius: their radius (m).
        wheel_separation_multiplier: corrects the separation.
        left_wheel_radius_multiplier: corrects the radius of the left wheels.
        right_wheel_radius_multiplier: corrects the radius of the right wheels.
        tf_frame_prefix_enable: whether a prefix is put before the frames' names.
        tf_frame_prefix: the prefix; empty: the namespace.
        odom_frame_id: the odometry's frame.
        base_frame_id: the base's frame.
        pose_covariance_diagonal: goes into the odometry as it is.
        twist_covariance_diagonal: goes into the odometry as it is.
        open_loop: odometry from the commands instead of the wheels.
        position_feedback: odometry from the wheels' positions instead of their velocities.
        enable_odom_tf: whether the odometry's transform is published.
        cmd_vel_timeout: how long a command holds (s); then the base brakes. 0: for ever.
        publish_limited_velocity: whether ``~/cmd_vel_out`` is published.
        velocity_rolling_window_size: how many velocities are averaged in the odometry.
        publish_rate: rate of the odometry (Hz).
        linear: limits of the velocity forwards.
        angular: limits of the velocity about z.
        use_stamped_vel: Humble's; false: ``~/cmd_vel_unstamped`` with ``Twist`` takes the place of ``~/cmd_vel``.
        wheels_per_side: Humble's; the names say it.
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
    wheels_per_side: int = field(default=0, metadata={"unsupported": "the wheels' names say how many there are"})

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
        """The drive with its corrections."""
        return DifferentialDrive(
            self.wheel_separation_multiplier * self.wheel_separation,
            self.left_wheel_radius_multiplier * self.wheel_radius,
            self.right_wheel_radius_multiplier * self.wheel_radius,
        )


@controller("diff_drive_controller/DiffDriveController")
class DiffDriveController(DriveController):
    """Drives a base with wheels on two sides by a commanded twist, within its limits, and reckons where it is.

    Behaves as ``diff_drive_controller/DiffDriveController`` does in ROS 2 Jazzy: a command older than
    ``cmd_vel_timeout`` counts as zero, so that the base brakes as its limits allow; nothing is written before the first
    command, and zero once the timeout has passed since the activation. Safer than upstream: a command that is not
    finite is refused, so that it does not prolong the one before it; see also `DriveController`.

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

    @classmethod
    def claimed_interfaces(
        cls, parameters: DiffDriveParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """The velocities of the left wheels, then of the right ones."""
        wheels = (*parameters.left_wheel_names, *parameters.right_wheel_names)
        return tuple(Interface(wheel, "velocity") for wheel in wheels)

    @classmethod
    def reference_interfaces(cls, parameters: Any, description: RobotDescription) -> tuple[Interface, ...]:
        """The base's velocity."""
        return Interface("linear", "velocity"), Interface("angular", "velocity")

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: DiffDriveParameters = setup.parameters
        self._drive = parameters.kinematics()
        self._limiters = (parameters.linear.x.limiter(), parameters.angular.z.limiter())
        wheels = (*parameters.left_wheel_names, *parameters.right_wheel_names)
        self._odometry_wheels = tuple(state_joint(wheel, setup.layout.velocities) for wheel in wheels)
        self._declare_command("cmd_vel", stamped=parameters.use_stamped_vel, timeout=parameters.cmd_vel_timeout)
        self._declare_odometry("odom")
        if parameters.publish_limited_velocity:
            self.declare_topic_output(
                "cmd_vel_out", "geometry_msgs/msg/TwistStamped", self._calc_cmd_vel_out, {self.sample_ticket()}
            )

    def update(self, context: Context, time: float, memory: DriveMemory) -> Update:
        """Limits the command, reckons the odometry and turns the wheels."""
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
        memory = publication(memory, time, parameters.publish_rate)
        if limited is None:
            return Update(memory, self.sample(context).commands)
        left, right = self._drive.wheel_velocities(*limited)
        per_side = len(parameters.left_wheel_names)
        return Update(memory, (left,) * per_side + (right,) * per_side)

    def _wanted(self, context: Context, time: float, memory: DriveMemory) -> tuple[float, ...] | None:
        """Return the velocity to follow; None for nothing, so that what was written stays."""
        chained = self.references(context)
        if chained is not None:
            return tuple(map(float, chained)) if all(map(isfinite, chained)) else None
        command = self.received(self.get_command_input_port(), context)
        if self._is_expired(time, memory.start if command is None else command.time):
            return 0.0, 0.0
        return None if command is None else (command.linear_x, command.angular_z)

    def _base_velocity(self, wheels: tuple[float, ...]) -> tuple[float, float]:
        per_side = len(wheels) // 2
        return self._drive.base_velocity(sum(wheels[:per_side]) / per_side, sum(wheels[per_side:]) / per_side)

    def _calc_cmd_vel_out(self, context: Context, output: AbstractValue) -> None:
        sample = self.sample(context)
        memory: DriveMemory | None = sample.memory
        if memory is None or memory.limited is None:
            output.set_value(None)
            return
        linear, angular = memory.limited
        output.set_value(
            messages.TwistStamped(header=messages.header(sample.time), twist=twist_message(linear, 0.0, angular))
        )
