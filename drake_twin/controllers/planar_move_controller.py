"""A base without driven wheels that follows a commanded planar twist, as in Gazebo's planar_move plugin."""

from dataclasses import field, replace
from math import cos, nan, sin
from typing import Any, ClassVar

from pydrake.systems.framework import Context

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.drive_controller import DriveController, DriveMemory, check_covariances
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.periodic_controller import PeriodicController, Update
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import PLANAR_INTERFACES
from drake_twin.description.planar_joints import ANGULAR_Z
from drake_twin.description.robot_description import RobotDescription

_COVARIANCE = (1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3)


@dataclass(frozen=True, kw_only=True)
class PlanarMoveParameters:
    """Parameters of ``gazebo_ros/PlanarMove``, named after those of ``libgazebo_ros_planar_move.so``.

    Attributes:
        odom_frame_id: The frame of the odometry; ``<odometry_frame>``.
        base_frame_id: The frame of the base; ``<robot_base_frame>``.
        pose_covariance_diagonal: The diagonal of the covariance of the odometry's pose.
        twist_covariance_diagonal: The diagonal of the covariance of the odometry's twist.
        enable_odom_tf: Whether the odometry's transform is published; ``<publish_odom_tf>``.
        publish_rate: The rate of the odometry (Hz).
        use_stamped_vel: Whether commands come as ``TwistStamped`` on ``~/cmd_vel`` instead of ``Twist`` on
            ``~/cmd_vel_unstamped``.
    """

    odom_frame_id: str = "odom"
    base_frame_id: str = "base_footprint"
    pose_covariance_diagonal: tuple[float, ...] = _COVARIANCE
    twist_covariance_diagonal: tuple[float, ...] = _COVARIANCE
    enable_odom_tf: bool = True
    publish_rate: float = field(default=20.0, metadata={"above": 0.0})
    use_stamped_vel: bool = False

    def __post_init__(self) -> None:
        check_covariances(self)


@controller("gazebo_ros/PlanarMove")
class PlanarMoveController(DriveController):
    """Command a base's planar velocity; the odometry is its true pose in the world, as with the plugin.

    A command is valid until the next one, as with the plugin; one that is not finite is refused.

    .. pydrake_system::

        name: PlanarMoveController
        input_ports:
        - state
        - cmd_vel_unstamped
        output_ports:
        - command_interfaces
        - odom
        - tf_odometry

    - ``cmd_vel_unstamped``: ``geometry_msgs/msg/Twist`` (m/s, rad/s), or ``cmd_vel``,
      ``geometry_msgs/msg/TwistStamped``, with ``use_stamped_vel``.
    - ``command_interfaces``: the velocities of the joints that move the base: along x and y of its start pose (m/s),
      and about z (rad/s); NaN before the first command.
    - ``odom``: ``nav_msgs/msg/Odometry`` at ``publish_rate``; None before the first update.
    - ``tf_odometry``: ``tf2_msgs/msg/TFMessage``, the same as a transform, for ``/tf``; with ``enable_odom_tf`` only.
    """

    Parameters: ClassVar[type] = PlanarMoveParameters

    @classmethod
    def claimed_interfaces(cls, parameters: Any, description: RobotDescription) -> tuple[Interface, ...]:
        """Return the velocities of the joints that move the base."""
        return tuple(Interface(*interface) for interface in PLANAR_INTERFACES)

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: PlanarMoveParameters = setup.parameters
        self._odometry_wheels = ()
        self._declare_command("cmd_vel", stamped=parameters.use_stamped_vel, timeout=0.0)
        self._declare_odometry("odom")

    def update(self, context: Context, time: float, memory: DriveMemory) -> Update:
        """Forward the command and measure the base's pose."""
        memory = replace(memory, odometry=self.true_odometry(context, time))
        memory = self._with_publication(memory, time, self.setup.parameters.publish_rate)
        command = self.received(self.get_command_input_port(), context)
        if command is None:
            return Update(memory, (nan, nan, nan))
        twist = (command.linear_x, command.linear_y, command.angular_z)
        return Update(memory, along_start(self, context, *twist))


def along_start(
    controller: PeriodicController, context: Context, linear_x: float, linear_y: float, angular_z: float
) -> tuple[float, float, float]:
    """Return the velocities of the joints that move a base, along and about the axes of its start pose.

    Until the next update the base moves straight while it turns: in the direction that it has halfway.

    Args:
        controller: The base's controller.
        context: The controller's own context.
        linear_x: The base's velocity forward (m/s).
        linear_y: Its velocity to the left (m/s).
        angular_z: Its angular velocity about z (rad/s).
    """
    (turned,) = controller.positions(context, [ANGULAR_Z])
    heading = turned + 0.5 * controller.setup.update_period * angular_z
    along_x = cos(heading) * linear_x - sin(heading) * linear_y
    along_y = sin(heading) * linear_x + cos(heading) * linear_y
    return along_x, along_y, angular_z
