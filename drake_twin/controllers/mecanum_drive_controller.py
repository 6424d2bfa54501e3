"""Mecanum drive: a base with four mecanum wheels that moves in any direction."""

from collections.abc import Container
from dataclasses import field, replace
from math import isnan
from typing import Any, ClassVar

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.control.drive_kinematics import MecanumDrive
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
from drake_twin.controllers.speed_limits import LimitsXY, LimitsZ, zero_jerk_limits
from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription
from drake_twin.systems.no_message import set_value

_ZEROS = (0.0,) * 6
_TENTHS = (0.1,) * 6
_WHEELS = ("front_left", "front_right", "rear_right", "rear_left")


@dataclass(frozen=True)
class BaseFrameOffset:
    """The pose of the base frame relative to the robot's center.

    Attributes:
        x: The forward offset (m).
        y: The offset to the left (m).
        theta: The angle about z (rad).
    """

    x: float = 0.0
    y: float = 0.0
    theta: float = 0.0


@dataclass(frozen=True, kw_only=True)
class MecanumKinematics:
    """The geometry of a mecanum base.

    Attributes:
        base_frame_offset: The pose of the base frame relative to the robot's center.
        wheels_radius: The radius of the wheels (m).
        sum_of_robot_center_projection_on_X_Y_axis: The distance from the center to a wheel along x, plus that along y
            (m).
    """

    base_frame_offset: BaseFrameOffset = BaseFrameOffset()
    wheels_radius: float = field(metadata={"above": 0.0})
    sum_of_robot_center_projection_on_X_Y_axis: float = field(metadata={"above": 0.0})  # noqa: N815


@dataclass(frozen=True, kw_only=True)
class HusarionMecanumDriveParameters:
    """Parameters of the same controller type in Husarion's fork, which has its own names, defaults and topics.

    A file with one of these wheel names is read with this class; the controller is the same `MecanumDriveController`.
    Limits apply without their flags, which are off by default in the fork.

    Attributes:
        front_left_wheel_name: The joint of the front left wheel, or a reference of another controller.
        front_right_wheel_name: The same for the front right wheel.
        rear_left_wheel_name: The same for the rear left wheel.
        rear_right_wheel_name: The same for the rear right wheel.
        wheel_separation_x: The distance between the front and rear wheels (m).
        wheel_separation_y: The distance between the left and right wheels (m).
        wheel_radius: The radius of the wheels (m).
        wheel_separation_x_multiplier: A correction factor of the separation.
        wheel_separation_y_multiplier: A correction factor of the separation.
        wheel_radius_multiplier: A correction factor of the radius.
        tf_frame_prefix_enable: Whether the frames' names get a prefix.
        tf_frame_prefix: The prefix; empty for the namespace.
        base_frame_id: The frame of the base.
        odom_frame_id: The frame of the odometry.
        enable_odom_tf: Whether the odometry's transform is published.
        twist_covariance_diagonal: The diagonal of the covariance of the odometry's twist.
        pose_covariance_diagonal: The diagonal of the covariance of the odometry's pose.
        cmd_vel_timeout: The time after which a command expires (s).
        use_stamped_vel: Whether ``~/cmd_vel`` takes ``TwistStamped``; if false, ``~/cmd_vel_unstamped`` takes
            ``Twist``.
        linear: The limits of the velocity in the plane.
        angular: The limits of the velocity about z.
        open_loop: Whether the odometry follows the commands instead of the wheels.
        position_feedback: Whether the odometry uses the wheels' positions instead of their velocities.
        publish_limited_velocity: Whether ``~/cmd_vel_out`` is published.
        publish_rate: The rate of the odometry (Hz).
        velocity_rolling_window_size: The number of velocities that the odometry averages.
    """

    signs: ClassVar[frozenset[str]] = frozenset(f"{wheel}_wheel_name" for wheel in _WHEELS)

    front_left_wheel_name: str
    front_right_wheel_name: str
    rear_left_wheel_name: str
    rear_right_wheel_name: str
    wheel_separation_x: float = field(metadata={"above": 0.0})
    wheel_separation_y: float = field(metadata={"above": 0.0})
    wheel_radius: float = field(metadata={"above": 0.0})
    wheel_separation_x_multiplier: float = field(default=1.0, metadata={"above": 0.0})
    wheel_separation_y_multiplier: float = field(default=1.0, metadata={"above": 0.0})
    wheel_radius_multiplier: float = field(default=1.0, metadata={"above": 0.0})
    tf_frame_prefix_enable: bool = True
    tf_frame_prefix: str = ""
    base_frame_id: str = "base_link"
    odom_frame_id: str = "odom"
    enable_odom_tf: bool = True
    twist_covariance_diagonal: tuple[float, ...] = _ZEROS
    pose_covariance_diagonal: tuple[float, ...] = _ZEROS
    cmd_vel_timeout: float = field(default=0.5, metadata={"lower": 0.0})
    use_stamped_vel: bool = True
    linear: LimitsXY = field(default_factory=LimitsXY)
    angular: LimitsZ = field(default_factory=LimitsZ)
    open_loop: bool = field(default=False, metadata={"unsupported": "the odometry always uses the wheels"})
    position_feedback: bool = field(
        default=False,
        metadata={"unsupported": "the odometry uses velocities, as that of mecanum_drive_controller does"},
    )
    publish_limited_velocity: bool = field(default=False, metadata={"unsupported": "the topic does not exist"})
    publish_rate: float = field(default=50.0, metadata={"unsupported": "the odometry is published at every update"})
    velocity_rolling_window_size: int = field(default=10, metadata={"unsupported": "velocities are not averaged"})

    def __post_init__(self) -> None:
        for name in sorted(self.signs):
            if not getattr(self, name):
                raise ParameterError(f"{name} is empty", name)
        check_covariances(self)

    def translated(self) -> "MecanumDriveParameters":
        """Return the parameters with the names of ros2_controllers."""
        across = self.wheel_separation_x_multiplier * self.wheel_separation_x
        across += self.wheel_separation_y_multiplier * self.wheel_separation_y
        return MecanumDriveParameters(
            reference_timeout=self.cmd_vel_timeout,
            front_left_wheel_command_joint_name=self.front_left_wheel_name,
            front_right_wheel_command_joint_name=self.front_right_wheel_name,
            rear_right_wheel_command_joint_name=self.rear_right_wheel_name,
            rear_left_wheel_command_joint_name=self.rear_left_wheel_name,
            kinematics=MecanumKinematics(
                wheels_radius=self.wheel_radius_multiplier * self.wheel_radius,
                sum_of_robot_center_projection_on_X_Y_axis=0.5 * across,
            ),
            tf_frame_prefix_enable=self.tf_frame_prefix_enable,
            tf_frame_prefix=self.tf_frame_prefix,
            base_frame_id=self.base_frame_id,
            odom_frame_id=self.odom_frame_id,
            enable_odom_tf=self.enable_odom_tf,
            twist_covariance_diagonal=self.twist_covariance_diagonal,
            pose_covariance_diagonal=self.pose_covariance_diagonal,
            linear=self.linear,
            angular=self.angular,
            use_stamped_vel=self.use_stamped_vel,
            command_topic="cmd_vel",
            odometry_topic="odom",
        )


@dataclass(frozen=True, kw_only=True)
class MecanumDriveParameters:
    """Parameters of ``mecanum_drive_controller/MecanumDriveController``.

    Attributes:
        reference_timeout: The time after which a command expires (s); with 0 it is valid for one update.
        front_left_wheel_command_joint_name: The joint of the front left wheel, or a reference of another controller.
        front_right_wheel_command_joint_name: The same for the front right wheel.
        rear_right_wheel_command_joint_name: The same for the rear right wheel.
        rear_left_wheel_command_joint_name: The same for the rear left wheel.
        front_left_wheel_state_joint_name: The joint whose velocity is measured; empty for the commanded one.
        front_right_wheel_state_joint_name: The same for the front right wheel.
        rear_right_wheel_state_joint_name: The same for the rear right wheel.
        rear_left_wheel_state_joint_name: The same for the rear left wheel.
        kinematics: The geometry.
        tf_frame_prefix_enable: Whether the frames' names get a prefix.
        tf_frame_prefix: The prefix; empty for the namespace.
        base_frame_id: The frame of the base.
        odom_frame_id: The frame of the odometry.
        enable_odom_tf: Whether the odometry's transform is published.
        twist_covariance_diagonal: The diagonal of the covariance of the odometry's twist.
        pose_covariance_diagonal: The diagonal of the covariance of the odometry's pose.
        linear: The limits of the velocity in the plane.
        angular: The limits of the velocity about z.
        use_stamped_vel: The twin's own; false replaces ``~/reference`` by ``~/reference_unstamped`` of type ``Twist``,
            as Humble's steering controllers do.
        command_topic: The twin's own: the command's topic below the controller's name.
        odometry_topic: The twin's own: the odometry's topic below the controller's name.
    """

    read_only: ClassVar[tuple[str, ...]] = (
        *("*_joint_name", "kinematics.*", "tf_frame_prefix", "base_frame_id", "odom_frame_id", "*_covariance_diagonal"),
    )
    live: ClassVar[tuple[str, ...]] = ("reference_timeout", "linear.*", "angular.*")

    dialects: ClassVar[tuple[type, ...]] = (HusarionMecanumDriveParameters,)

    reference_timeout: float = field(default=0.0, metadata={"lower": 0.0})
    front_left_wheel_command_joint_name: str
    front_right_wheel_command_joint_name: str
    rear_right_wheel_command_joint_name: str
    rear_left_wheel_command_joint_name: str
    front_left_wheel_state_joint_name: str = ""
    front_right_wheel_state_joint_name: str = ""
    rear_right_wheel_state_joint_name: str = ""
    rear_left_wheel_state_joint_name: str = ""
    kinematics: MecanumKinematics
    tf_frame_prefix_enable: bool = True
    tf_frame_prefix: str = ""
    base_frame_id: str = "base_link"
    odom_frame_id: str = "odom"
    enable_odom_tf: bool = True
    twist_covariance_diagonal: tuple[float, ...] = _TENTHS
    pose_covariance_diagonal: tuple[float, ...] = _TENTHS
    linear: LimitsXY = field(default_factory=LimitsXY)
    angular: LimitsZ = field(default_factory=LimitsZ)
    use_stamped_vel: bool = True
    command_topic: str = field(default="reference", metadata={"choices": ("reference", "cmd_vel")})
    odometry_topic: str = field(default="odometry", metadata={"choices": ("odometry", "odom")})

    def __post_init__(self) -> None:
        for wheel in _WHEELS:
            name = f"{wheel}_wheel_command_joint_name"
            if not getattr(self, name):
                raise ParameterError(f"{name} is empty", name)
        check_covariances(self)

    @property
    def command_joints(self) -> tuple[str, ...]:
        """The commanded joints: front left, front right, rear right, rear left."""
        return tuple(getattr(self, f"{wheel}_wheel_command_joint_name") for wheel in _WHEELS)

    def state_joints(self, joints: Container[str]) -> tuple[str, ...]:
        """Return the robot's joints that are measured, in the same order."""
        measured = (getattr(self, f"{wheel}_wheel_state_joint_name") for wheel in _WHEELS)
        return tuple(
            state_joint(name or command, joints) for name, command in zip(measured, self.command_joints, strict=True)
        )


@controller("mecanum_drive_controller/MecanumDriveController")
class MecanumDriveController(DriveController):
    """Drive a base on mecanum wheels at a commanded twist, and publish its odometry.

    Behaves as ``mecanum_drive_controller/MecanumDriveController`` does in ROS 2 Jazzy: the wheels are commanded zero
    before the first command, after a NaN command, and after ``reference_timeout``. With a time-out of zero, the
    default, a command is valid for one update.

    .. pydrake_system::

        name: MecanumDriveController
        input_ports:
        - state
        - reference
        - <upstream controller>
        output_ports:
        - command_interfaces
        - odometry
        - tf_odometry
        - controller_state

    - ``reference``: ``geometry_msgs/msg/TwistStamped`` (m/s, rad/s), or ``reference_unstamped``,
      ``geometry_msgs/msg/Twist``, with ``use_stamped_vel: false``; topic below the controller's name. With Husarion's
      parameters it is ``cmd_vel``, and ``odometry`` is ``odom``.
    - ``command_interfaces``: velocities (rad/s) of the wheels front left, front right, rear right, rear left.
    - ``odometry``: ``nav_msgs/msg/Odometry`` at every update; None before the first.
    - ``tf_odometry``: ``tf2_msgs/msg/TFMessage``, the same as a transform, for ``/tf``; with ``enable_odom_tf`` only.
    - ``controller_state``: ``control_msgs/msg/MecanumDriveControllerState`` at every update.

    References for other controllers: ``linear/x/velocity``, ``linear/y/velocity`` (m/s) and ``angular/z/velocity``
    (rad/s).
    """

    Parameters: ClassVar[type] = MecanumDriveParameters
    _components = ("linear_x", "linear_y", "angular_z")
    _nan_stops = True

    @classmethod
    def claimed_interfaces(
        cls, parameters: MecanumDriveParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return the velocities of the wheels front left, front right, rear right, rear left."""
        return tuple(Interface(joint, "velocity") for joint in parameters.command_joints)

    @classmethod
    def reference_interfaces(cls, parameters: Any, description: RobotDescription) -> tuple[Interface, ...]:
        """Return the base's velocity as references."""
        return tuple(Interface(name, "velocity") for name in ("linear/x", "linear/y", "angular/z"))

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: MecanumDriveParameters = setup.parameters
        geometry = parameters.kinematics
        offset = geometry.base_frame_offset
        self._drive = MecanumDrive(
            geometry.wheels_radius,
            geometry.sum_of_robot_center_projection_on_X_Y_axis,
            (offset.x, offset.y, offset.theta),
        )
        limits = (parameters.linear.x, parameters.linear.y, parameters.angular.z)
        self._limiters = tuple(each.limiter() for each in limits)
        self.warnings += tuple(zero_jerk_limits(parameters))
        self._odometry_wheels = parameters.state_joints(setup.layout.velocities)
        self._declare_command(
            parameters.command_topic, stamped=parameters.use_stamped_vel, timeout=parameters.reference_timeout
        )
        self._declare_odometry(parameters.odometry_topic)
        self.declare_topic_output(
            "controller_state",
            "control_msgs/msg/MecanumDriveControllerState",
            self._calc_controller_state,
            {self.sample_ticket()},
        )

    def update(self, context: Context, time: float, memory: DriveMemory) -> Update:
        """Update the odometry, limit the command and drive the wheels."""
        wheels, memory = self._feedback(context, memory, time, from_positions=False)
        odometry = memory.odometry.moved_sideways_too(*self._drive.base_velocity(*wheels), time)
        memory = self._with_publication(replace(memory, odometry=odometry), time)
        reference, memory = self._reference(context, time, memory)
        memory = replace(memory, state=(*wheels, *reference))
        if any(map(isnan, reference)):
            return Update(replace(memory, limited=None), (0.0,) * 4)
        limited = self._limited(reference, memory)
        memory = replace(memory, last=limited, second_to_last=memory.last, limited=limited)
        return Update(memory, self._drive.wheel_velocities(*limited))

    def _calc_controller_state(self, context: Context, output: AbstractValue) -> None:
        sample = self.sample(context)
        if sample.memory is None or not sample.memory.state:
            set_value(output, None)
            return
        front_left, front_right, rear_right, rear_left, *reference = sample.memory.state
        output.set_value(
            messages.MecanumDriveControllerState(
                header=messages.header(sample.time, self._frames[0]),
                front_left_wheel_velocity=front_left,
                back_left_wheel_velocity=rear_left,
                back_right_wheel_velocity=rear_right,
                front_right_wheel_velocity=front_right,
                reference_velocity=twist_message(*reference),
            )
        )
