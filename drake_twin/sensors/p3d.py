"""The true pose of a link, as Gazebo classic's plugin gazebo_ros_p3d publishes it."""

from collections.abc import Iterable

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.math import RollPitchYaw
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.robot_description import Sensor, Vector3
from drake_twin.description.sensor_element import SensorElement
from drake_twin.sensors.classic import classic_plugin, classic_topic
from drake_twin.sensors.noise import Noise
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem, SensorTopic

_WORLDS = ("world", "/world", "map", "/map")


@dataclass(frozen=True)
class P3DSettings:
    """What the plugin reads of its element.

    Attributes:
        offset: Added to the position (m).
        turn: Roll, pitch, yaw before the orientation (rad).
        stddev: The standard deviation of the noise of each velocity (m/s, rad/s), and the root of all variances.
        reference: The link whose frame it is relative to; empty for the world.
    """

    offset: Vector3
    turn: Vector3
    stddev: float
    reference: str


@sensor("gazebo_ros_p3d")
class P3D(SensorSystem):
    """Publish the true pose of a link in the world or in another link (gazebo_plugins/src/gazebo_ros_p3d.cpp).

    The twist is in the world's axes. Relative to a link, the plugin multiplies the orientations in the order
    ``R_WL · R_WF⁻¹``, and turns velocities by ``R_WF``: so does this.

    .. pydrake_system::

        name: P3D
        input_ports:
        - body_poses
        - body_spatial_velocities
        output_ports:
        - message

    - ``body_poses``, ``body_spatial_velocities``: the plant's ports of these names.
    - ``message``: ``nav_msgs/msg/Odometry`` of the present time.
    """

    message_type = "nav_msgs/msg/Odometry"

    @classmethod
    def read(cls, element: SensorElement) -> P3DSettings:
        """Read offset, noise and reference.

        Raises:
            InputError: If a value is invalid.
        """
        for name in ("body_name", "update_rate", "frame_name"):
            element.has(name)
        offset, turn = (
            element.numbers(f"{name}_offset", 3, element.numbers(f"{name}_offsets", 3, (0.0,) * 3))
            for name in ("xyz", "rpy")
        )
        frame = element.sensor.frame
        return P3DSettings(
            (offset[0], offset[1], offset[2]),
            (turn[0], turn[1], turn[2]),
            element.number("gaussian_noise", 0.0, least=0.0),
            "" if frame in ("", *_WORLDS) else frame,
        )

    @classmethod
    def topics(cls, sensor: Sensor, settings: P3DSettings, base: str) -> Iterable[SensorTopic]:
        """Return its topic: ``odom``, unless it is remapped."""
        plugin = classic_plugin(sensor)
        assert plugin is not None, "it is a plugin"
        return (SensorTopic("message", cls.message_type, classic_topic(plugin, "odom"), is_ros=True),)

    @classmethod
    def default_frame(cls, sensor: Sensor, settings: P3DSettings, scoped: str) -> str:
        """Return ``world``."""
        return "world"

    @classmethod
    def noises(cls, settings: P3DSettings) -> dict[str, Noise]:
        """Return the noise of each velocity."""
        return {"linear": Noise(stddev=settings.stddev), "angular": Noise(stddev=settings.stddev)}

    def __init__(self, setup: SensorSetup):
        super().__init__(setup)
        settings: P3DSettings = setup.settings
        self._body = int(setup.body.index())
        self._reference = None
        if setup.plant.HasBodyNamed(drake_link_name(settings.reference), setup.instance):
            body = setup.plant.GetBodyByName(drake_link_name(settings.reference), setup.instance)
            self._reference = int(body.index())
        elif settings.reference:
            self.warnings = (f"the robot has no link {settings.reference!r}, so its pose is that in the world",)
        self._turn = RollPitchYaw(*settings.turn).ToRotationMatrix()
        self._covariance = np.diag([settings.stddev**2] * 6).ravel()
        self._poses = self.declare_plant_input("body_poses")
        self._velocities = self.declare_plant_input("body_spatial_velocities")
        self.declare_message_output(self._calc)

    def _calc(self, context: Context, output: AbstractValue) -> None:
        settings: P3DSettings = self.setup.settings
        poses, velocities = self._poses.Eval(context), self._velocities.Eval(context)
        position, turn = np.array(poses[self._body].translation()), poses[self._body].rotation()
        linear, angular = (np.array(part) for part in _parts(velocities[self._body]))
        if self._reference is not None:
            frame = poses[self._reference]
            frame_linear, frame_angular = _parts(velocities[self._reference])
            position = frame.rotation().inverse().multiply(position - frame.translation())
            turn = turn @ frame.rotation().inverse()
            linear = frame.rotation().multiply(linear - frame_linear)
            angular = frame.rotation().multiply(angular - frame_angular)
        time = context.get_time()
        x, y, z = (position + settings.offset).tolist()
        qw, qx, qy, qz = (self._turn @ turn).ToQuaternion().wxyz().tolist()
        vx, vy, vz = self.noisy("linear", linear, time).tolist()
        wx, wy, wz = self.noisy("angular", angular, time).tolist()
        output.set_value(
            messages.Odometry(
                header=self.header(context),
                child_frame_id=self.setup.frame_prefix + self.setup.sensor.gazebo_link,
                pose=messages.PoseWithCovariance(
                    pose=messages.Pose(
                        position=messages.Point(x=x, y=y, z=z),
                        orientation=messages.Quaternion(x=qx, y=qy, z=qz, w=qw),
                    ),
                    covariance=self._covariance,
                ),
                twist=messages.TwistWithCovariance(
                    twist=messages.Twist(
                        linear=messages.Vector3(x=vx, y=vy, z=vz), angular=messages.Vector3(x=wx, y=wy, z=wz)
                    ),
                    covariance=self._covariance,
                ),
            )
        )


def _parts(velocity: object) -> tuple[np.ndarray, np.ndarray]:
    return np.array(velocity.translational()), np.array(velocity.rotational())  # type: ignore[attr-defined]
