"""Omnidirectional drive: a base with three or more omni wheels on a circle that moves in any direction."""

from dataclasses import field, replace
from typing import Any, ClassVar

from pydrake.systems.framework import Context

from drake_twin.control.drive_kinematics import OmniWheelDrive
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.drive_controller import DriveController, DriveMemory, check_covariances, state_joint
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.periodic_controller import Update
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription

_ZEROS = (0.0,) * 6


@dataclass(frozen=True)
class DiagonalCovariance:
    """The diagonals of the odometry's covariances.

    Attributes:
        pose: That of the pose.
        twist: That of the twist.
    """

    pose: tuple[float, ...] = _ZEROS
    twist: tuple[float, ...] = _ZEROS

    def __post_init__(self) -> None:
        check_covariances(self, "pose", "twist")


@dataclass(frozen=True, kw_only=True)
class OmniWheelDriveParameters:
    """Parameters of ``omni_wheel_drive_controller/OmniWheelDriveController``.

    Attributes:
        wheel_offset: The angle of the first wheel from the base's x axis (rad).
        wheel_names: The joints of the wheels, counterclockwise from the first one, or references of another controller.
        robot_radius: The distance from the base's center to a wheel (m).
        wheel_radius: The radius of the wheels (m).
        tf_frame_prefix_enable: Whether the frames' names get a prefix.
        tf_frame_prefix: The prefix; empty for the namespace.
        odom_frame_id: The frame of the odometry.
        base_frame_id: The frame of the base.
        diagonal_covariance: The diagonals of the odometry's covariances.
        open_loop: Whether the odometry follows the commands instead of the wheels.
        position_feedback: Whether the odometry uses the wheels' positions instead of their velocities.
        enable_odom_tf: Whether the odometry's transform is published.
        cmd_vel_timeout: The time after which a command expires and the base stops (s); 0 for never.
    """

    read_only: ClassVar[tuple[str, ...]] = ("*",)

    wheel_offset: float
    wheel_names: tuple[str, ...]
    robot_radius: float = field(metadata={"above": 0.0})
    wheel_radius: float = field(metadata={"above": 0.0})
    tf_frame_prefix_enable: bool = True
    tf_frame_prefix: str = ""
    odom_frame_id: str = "odom"
    base_frame_id: str = "base_link"
    diagonal_covariance: DiagonalCovariance = DiagonalCovariance()
    open_loop: bool = False
    position_feedback: bool = True
    enable_odom_tf: bool = True
    cmd_vel_timeout: float = field(default=0.5, metadata={"lower": 0.0})

    def __post_init__(self) -> None:
        if len(self.wheel_names) < 3:
            raise ParameterError(f"there are {len(self.wheel_names)} wheels; at least three are needed", "wheel_names")

    @property
    def pose_covariance_diagonal(self) -> tuple[float, ...]:
        """The diagonal of the covariance of the odometry's pose."""
        return self.diagonal_covariance.pose

    @property
    def twist_covariance_diagonal(self) -> tuple[float, ...]:
        """The diagonal of the covariance of the odometry's twist."""
        return self.diagonal_covariance.twist


@controller("omni_wheel_drive_controller/OmniWheelDriveController")
class OmniWheelDriveController(DriveController):
    """Drive a base on omni wheels at a commanded twist, and publish its odometry.

    Behaves as ``omni_wheel_drive_controller/OmniWheelDriveController`` in ROS 2 Jazzy: once a command is older than
    ``cmd_vel_timeout``, the wheels are commanded zero. Before the first command nothing is written, and zero once the
    time-out has passed since the activation. Unlike upstream, a command that is not finite is refused, and does not
    prolong the previous one; with a time-out of zero, which upstream never lets a wheel turn, a command is valid for
    ever. See also `DriveController`.

    .. pydrake_system::

        name: OmniWheelDriveController
        input_ports:
        - state
        - cmd_vel
        - <upstream controller>
        output_ports:
        - command_interfaces
        - odom
        - tf_odometry

    - ``cmd_vel``: ``geometry_msgs/msg/TwistStamped`` (m/s, rad/s); topic below the controller's name.
    - ``command_interfaces``: velocities of the wheels (rad/s).
    - ``odom``: ``nav_msgs/msg/Odometry`` at every update; None before the first.
    - ``tf_odometry``: ``tf2_msgs/msg/TFMessage``, the same as a transform, for ``/tf``; with ``enable_odom_tf`` only.

    References for other controllers: ``linear/x/velocity``, ``linear/y/velocity`` (m/s) and ``angular/z/velocity``
    (rad/s).
    """

    Parameters: ClassVar[type] = OmniWheelDriveParameters
    _components = ("linear_x", "linear_y", "angular_z")
    halt_value = 0.0

    @classmethod
    def claimed_interfaces(
        cls, parameters: OmniWheelDriveParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return the velocity of each wheel."""
        return tuple(Interface(wheel, "velocity") for wheel in parameters.wheel_names)

    @classmethod
    def reference_interfaces(cls, parameters: Any, description: RobotDescription) -> tuple[Interface, ...]:
        """Return the base's velocity as references."""
        return tuple(Interface(name, "velocity") for name in ("linear/x", "linear/y", "angular/z"))

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: OmniWheelDriveParameters = setup.parameters
        wheels = parameters.wheel_names
        self._drive = OmniWheelDrive(
            parameters.wheel_radius, parameters.robot_radius, len(wheels), parameters.wheel_offset
        )
        self._odometry_wheels = tuple(state_joint(wheel, setup.layout.velocities) for wheel in wheels)
        self._declare_command("cmd_vel", stamped=True, timeout=parameters.cmd_vel_timeout)
        self._declare_odometry("odom")

    def update(self, context: Context, time: float, memory: DriveMemory) -> Update:
        """Update the odometry and drive the wheels."""
        parameters: OmniWheelDriveParameters = self.setup.parameters
        wanted = self._wanted(context, time, memory)
        if parameters.open_loop:
            x, y, angular = wanted or (0.0, 0.0, 0.0)
        else:
            wheels, memory = self._feedback(context, memory, time, from_positions=parameters.position_feedback)
            x, y, angular = self._drive.base_velocity(*wheels)
        odometry = memory.odometry.moved_on_an_arc(x, y, angular, time)
        memory = self._with_publication(replace(memory, odometry=odometry), time)
        written = self.sample(context).commands if wanted is None else self._drive.wheel_velocities(*wanted)
        return Update(memory, written)
