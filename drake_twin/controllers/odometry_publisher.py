"""A robot's true pose and velocity as odometry, as gz-sim's OdometryPublisher publishes them."""

from dataclasses import field
from typing import Any, ClassVar

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.odometry_frames import odometry_frames
from drake_twin.controllers.registry import controller
from drake_twin.controllers.sensor_broadcaster import transform_message
from drake_twin.controllers.truth_broadcaster import TruthBroadcaster
from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.gazebo_drive import ODOMETRY_PUBLISHER
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import Pose
from drake_twin.kinematics.rotations import along_heading, heading_of, rotated
from drake_twin.sensors.motion_sensor import SIZE, MotionSensor
from drake_twin.sensors.sensor_setup import transform

_ZERO = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class OdometryPublisherParameters:
    """Parameters of ``gz_sim/OdometryPublisher``, named after the elements of ``gz-sim-odometry-publisher-system``.

    Attributes:
        odom_frame: The frame of the odometry.
        robot_base_frame: The frame of the base.
        dimensions: 2 for the place and the velocity in the plane, 3 for all of them.
        xyz_offset: The origin of the frame that is measured, in the model's frame (m).
        rpy_offset: Its roll, pitch and yaw there (rad).
        gaussian_noise: The standard deviation of the noise, for the covariances.
        enable_odom_tf: Whether the transform is published.
        tf_frame_prefix_enable: Whether the namespace goes before the odometry's frame.
    """

    odom_frame: str = "odom"
    robot_base_frame: str = "base_footprint"
    dimensions: int = field(default=2, metadata={"lower": 2, "upper": 3})
    xyz_offset: tuple[float, ...] = _ZERO
    rpy_offset: tuple[float, ...] = _ZERO
    gaussian_noise: float = field(default=0.0, metadata={"lower": 0.0})
    enable_odom_tf: bool = True
    tf_frame_prefix_enable: bool = False

    def __post_init__(self) -> None:
        for name in ("xyz_offset", "rpy_offset"):
            if len(getattr(self, name)) != 3:
                raise ParameterError(f"{name} has {len(getattr(self, name))} numbers, where three are needed", name)


@controller(ODOMETRY_PUBLISHER)
class OdometryPublisher(TruthBroadcaster):
    """Publish the true pose and velocity of the model's frame in the world, whatever moves it.

    Behaves as gz-sim's OdometryPublisher (from its sources), but for velocities, which are those of the present time in
    place of means over the last ten steps, and for the noise, which the covariances have alone. With two dimensions the
    place has no height and the velocity is along the heading; the orientation is whole in both.

    .. pydrake_system::

        name: OdometryPublisher
        input_ports:
        - motion
        output_ports:
        - odom
        - odom_with_covariance
        - tf_odometry

    - ``motion``: as from `MotionSensor`.
    - ``odom``: ``nav_msgs/msg/Odometry`` of the present time, with covariances of zero; None while inactive.
    - ``odom_with_covariance``: the same with the covariances of the noise.
    - ``tf_odometry``: ``tf2_msgs/msg/TFMessage``, the same as a transform, for ``/tf``; with ``enable_odom_tf`` only.
    """

    Parameters: ClassVar[type] = OdometryPublisherParameters

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup, "motion")
        parameters: OdometryPublisherParameters = setup.parameters
        named = (setup, parameters.odom_frame, parameters.robot_base_frame)
        odom_frame, _ = odometry_frames(*named, prefix_enable=parameters.tf_frame_prefix_enable)
        self._frames = odom_frame, odometry_frames(*named)[1]
        self._covariance = np.diag([parameters.gaussian_noise**2] * 6).ravel()
        kind = "nav_msgs/msg/Odometry"
        self.declare_message_output("odom", kind, self._odom, self._present())
        self.declare_message_output("odom_with_covariance", kind, self._odom_with_covariance, self._present())
        if parameters.enable_odom_tf:
            self.odometry_frames = self._frames
            self.declare_message_output("tf_odometry", "tf2_msgs/msg/TFMessage", self._tf, self._present())

    def num_values(self) -> int:
        """Return the size of the port ``motion``."""
        return SIZE

    def own_sensor(self, plant: MultibodyPlant, instance: ModelInstanceIndex) -> MotionSensor:
        """Return a sensor of the frame that is measured: on the root link, which may not be in the model's frame."""
        description, parameters = self.setup.description, self.setup.parameters
        X_MR = transform(description.root_pose)
        X_MF = transform(Pose(tuple(parameters.xyz_offset), tuple(parameters.rpy_offset)))
        X_RF: RigidTransform = X_MR.inverse() @ X_MF
        body = plant.GetBodyByName(drake_link_name(description.root_link), instance)
        return MotionSensor(body.index(), X_RF)

    def _odom(self, context: Context) -> Any:
        return self._odometry(context, np.zeros(36))

    def _odom_with_covariance(self, context: Context) -> Any:
        return self._odometry(context, self._covariance)

    def _odometry(self, context: Context, covariance: np.ndarray) -> Any:
        x, y, z, *quaternion = self._pose(context)
        angular, linear = self._velocity(context, quaternion)
        odom_frame, base_frame = self._frames
        return messages.Odometry(
            header=messages.header(context.get_time(), odom_frame),
            child_frame_id=base_frame,
            pose=messages.PoseWithCovariance(
                pose=messages.Pose(messages.Point(x, y, z), messages.Quaternion(*quaternion)),
                covariance=covariance.copy(),
            ),
            twist=messages.TwistWithCovariance(
                twist=messages.Twist(linear=messages.Vector3(*linear), angular=messages.Vector3(*angular)),
                covariance=covariance.copy(),
            ),
        )

    def _tf(self, context: Context) -> Any:
        return messages.TFMessage([transform_message(context.get_time(), *self._frames, self._pose(context))])

    def _pose(self, context: Context) -> list[float]:
        """Return the place (m) and the orientation (x, y, z, w)."""
        pose: list[float] = self._sensor.Eval(context)[:7].tolist()
        if self.setup.parameters.dimensions == 2:
            pose[2] = 0.0
        return pose

    def _velocity(self, context: Context, quaternion: list[float]) -> tuple[list[float], list[float]]:
        """Return the angular and the linear velocity (rad/s, m/s): of the frame, or in the plane along the heading."""
        motion = self._sensor.Eval(context)
        angular, linear = motion[7:10], motion[10:13]
        if self.setup.parameters.dimensions == 3:
            return angular.tolist(), linear.tolist()
        x, y, z, w = quaternion
        ((along_x, along_y, _),) = rotated(np.array([[w, x, y, z]]), linear[None]).tolist()
        return [0.0, 0.0, float(angular[2])], [*along_heading(heading_of(w, x, y, z), along_x, along_y), 0.0]
