"""An IMU on a link."""

from collections.abc import Iterable
from math import pi

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.math import RollPitchYaw, RotationMatrix
from pydrake.systems.framework import BasicVector, Context

from drake_twin import messages
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import Sensor, Vector3
from drake_twin.description.sensor_element import SensorElement
from drake_twin.sensors.classic import classic_plugin, classic_topic
from drake_twin.sensors.noise import SILENT, Noise, read_noise
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem, SensorTopic

# The frames that an IMU's orientation can be relative to, in a world whose x, y and z are east, north and up.
_LOCALIZATIONS: dict[str, Vector3] = {"ENU": (0.0, 0.0, 0.0), "NWU": (0.0, 0.0, pi / 2), "NED": (pi, 0.0, pi / 2)}
_CHANNELS = (
    *(f"orientation.{axis}" for axis in "wxyz"),
    *(f"angular_velocity.{axis}" for axis in "xyz"),
    *(f"linear_acceleration.{axis}" for axis in "xyz"),
)
_PARTS = {"orientation": "xyz", "angular_velocity": "xyz", "linear_acceleration": "xyz"}
_NOT_PUBLISHED = -1.0  # of a covariance's first element, by sensor_msgs/msg/Imu


@dataclass(frozen=True)
class ImuSettings:
    """What an IMU reads of its element.

    Attributes:
        reference: The frame that its orientation is relative to, as roll, pitch, yaw in the world (rad); None for its
            orientation at the start, as in Gazebo.
        noises: Channel → its noise (rad/s, m/s², none), where it has some.
        has_orientation: Whether it measures its orientation.
    """

    reference: Vector3 | None
    noises: dict[str, Noise]
    has_orientation: bool = True


@sensor("imu", "gazebo_ros_imu")
class ImuSensor(SensorSystem):
    """Measure orientation, angular velocity and specific force at a point of a link.

    Like gz-sensors' ImuSensor (src/ImuSensor.cc) and gz-sim's Imu system (src/systems/imu/Imu.cc): the linear
    acceleration includes gravity, so that an IMU at rest measures +9.81 upwards, the orientation is relative to a
    reference, and the noise's variance is in the covariances. The output is computed on demand.

    The plant's accelerations must be those of the present state, as a continuous plant's always are. A discrete plant's
    are without sampled output ports (``use_sampled_output_ports=False``), for the next step with the present commands.

    .. pydrake_system::

        name: ImuSensor
        input_ports:
        - body_poses
        - body_spatial_velocities
        - body_spatial_accelerations
        output_ports:
        - spatial
        - message

    - ``body_poses``, ``body_spatial_velocities``, ``body_spatial_accelerations``: the plant's ports of these names.
    - ``spatial``: vector ``[qw qx qy qz, wx wy wz, ax ay az]``: the sensor's orientation relative to its reference, its
      angular velocity (rad/s) and linear acceleration (m/s²) in its own axes, with noise.
    - ``message``: the same as ``sensor_msgs/msg/Imu`` of the present time.
    """

    message_type = "sensor_msgs/msg/Imu"
    gz_topic = "imu"
    values_port = "spatial"

    @classmethod
    def read(cls, element: SensorElement) -> ImuSettings:
        """Read reference and noise.

        Raises:
            InputError: If a value is invalid.
        """
        if element.sensor.kind == "gazebo_ros_imu":  # ROS 1's plugin of a model; it still stands in files
            return ImuSettings(_LOCALIZATIONS["ENU"], _of_plugin(element))
        noises = {
            channel: noise
            for channel in _CHANNELS[4:]
            if (noise := read_noise(element, f"imu/{channel.replace('.', '/')}/noise")) != SILENT
        }
        if (plugin := element.part("plugin")) is not None:
            noises = noises or _of_plugin(plugin)
        return ImuSettings(_reference(element), noises, element.flag("imu/enable_orientation", True))

    @classmethod
    def topics(cls, sensor: Sensor, settings: ImuSettings, base: str) -> Iterable[SensorTopic]:
        """Return its topic: ``~/out`` of Gazebo classic's plugin, ``topicName`` of ROS 1's."""
        if sensor.kind == "gazebo_ros_imu":
            name = SensorElement(sensor).text("topicName", default="imu_data")
        elif (plugin := classic_plugin(sensor, "gazebo_ros_imu_sensor")) is not None:
            name = classic_topic(plugin, "~/out")
        else:
            return (SensorTopic("message", cls.message_type, base),)
        return (SensorTopic("message", cls.message_type, name, is_ros=True),)

    def __init__(self, setup: SensorSetup):
        super().__init__(setup)
        settings: ImuSettings = setup.settings
        self._body = int(setup.body.index())
        pose = setup.pose
        self._R_BS = pose.rotation()
        self._p_BS_B = np.array(pose.translation())
        if settings.reference is None:
            reference = setup.start.rotation()
        else:
            reference = RotationMatrix(RollPitchYaw(*settings.reference))
        self._R_RW = reference.inverse()
        self._gravity = np.array(setup.plant.gravity_field().gravity_vector())
        self._poses = self.declare_plant_input("body_poses")
        self._velocities = self.declare_plant_input("body_spatial_velocities")
        self._accelerations = self.declare_plant_input("body_spatial_accelerations")
        self._spatial = self.declare_values_output(len(_CHANNELS), self._calc_spatial)
        self._covariances = [_covariance(settings.noises, part, axes) for part, axes in _PARTS.items()]
        if not settings.has_orientation:
            self._covariances[0][0] = _NOT_PUBLISHED
        self.declare_message_output(self._calc_imu)

    def _calc_spatial(self, context: Context, output: BasicVector) -> None:
        R_WB: RotationMatrix = self._poses.Eval(context)[self._body].rotation()
        w_WB = np.array(self._velocities.Eval(context)[self._body].rotational())
        A_WB = self._accelerations.Eval(context)[self._body]
        R_WS = R_WB @ self._R_BS
        p_BS_W = R_WB.matrix() @ self._p_BS_B
        a_WS = (
            np.array(A_WB.translational())
            + np.cross(A_WB.rotational(), p_BS_W)
            + np.cross(w_WB, np.cross(w_WB, p_BS_W))
        )
        R_SW = R_WS.matrix().T
        orientation = (self._R_RW @ R_WS).ToQuaternion().wxyz()
        values = np.concatenate([orientation, R_SW @ w_WB, R_SW @ (a_WS - self._gravity)])
        output.SetFromVector(self.noisy_values(_CHANNELS, values, context.get_time()))

    def _calc_imu(self, context: Context, output: AbstractValue) -> None:
        values = self._spatial.Eval(context).tolist()
        if not self.setup.settings.has_orientation:
            values[:4] = 1.0, 0.0, 0.0, 0.0
        output.set_value(messages.imu_message(self.header(context), values, self._covariances))


def _covariance(noises: dict[str, Noise], part: str, axes: str) -> np.ndarray:
    return np.diag([noises.get(f"{part}.{axis}", SILENT).stddev ** 2 for axis in axes]).ravel()


def _of_plugin(plugin: SensorElement) -> dict[str, Noise]:
    """Read the noise of ROS 1's plugins, which all ten numbers have."""
    stddev = plugin.number("gaussianNoise", 0.0, least=0.0)
    return dict.fromkeys(_CHANNELS, Noise(stddev=stddev)) if stddev else {}


def _reference(element: SensorElement) -> Vector3 | None:
    """Read the reference as gz-sim does: a named frame, one of the file's own, or the orientation at the start."""
    tags = ("initial_orientation_as_reference", "initialOrientationAsReference")
    given = element.text(*(f"plugin/{tag}" for tag in tags)).lower()
    if given in ("0", "false") or (not given and element.plugin_kind == "gazebo_ros_imu_sensor"):
        return _LOCALIZATIONS["ENU"]  # REP 145
    if (frame := element.part("imu/orientation_reference_frame")) is None:
        return None
    localization = frame.text("localization", default="CUSTOM")
    if localization in _LOCALIZATIONS:
        return _LOCALIZATIONS[localization]
    if localization not in ("CUSTOM", "GRAV_UP", "GRAV_DOWN"):
        valid = ("CUSTOM", *_LOCALIZATIONS)
        raise frame.error(f"unknown localization {localization!r}", value=localization, valid=valid)
    roll, pitch, yaw = frame.numbers("custom_rpy", 3, (0.0, 0.0, 0.0))
    return roll, pitch, yaw
