"""A receiver of satellite navigation on a link."""

from collections.abc import Iterable
from math import atan2, cos, degrees, hypot, radians, sin, sqrt

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import Sensor
from drake_twin.description.sensor_element import SensorElement
from drake_twin.description.surroundings import SphericalCoordinates
from drake_twin.sensors.classic import classic_plugin, classic_topic
from drake_twin.sensors.noise import SILENT, Noise, read_noise
from drake_twin.sensors.point_motion import PointMotion
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem, SensorTopic
from drake_twin.systems.no_message import set_value

_A, _F = 6378137.0, 1 / 298.257223563  # WGS 84: semi-major axis (m), flattening
_B, _E2 = _A * (1 - _F), _F * (2 - _F)
_DIAGONAL_KNOWN = 2  # sensor_msgs/msg/NavSatFix


@dataclass(frozen=True)
class NavSatSettings:
    """What a receiver reads of its element.

    Attributes:
        noises: ``horizontal`` and ``vertical``, of the position (degrees and m in Gazebo, m in Gazebo classic), and
            ``horizontal_velocity`` and ``vertical_velocity`` (m/s).
        is_classic: Whether Gazebo classic's plugin publishes it.
    """

    noises: dict[str, Noise]
    is_classic: bool


class Tangent:
    """The plane in which a world lies on Earth (gz-math, src/SphericalCoordinates.cc, ``LOCAL``)."""

    def __init__(self, place: SphericalCoordinates):
        latitude, longitude, heading = map(radians, (place.latitude, place.longitude, place.heading))
        self._heading = np.array(
            [[cos(heading), -sin(heading), 0.0], [sin(heading), cos(heading), 0.0], [0.0, 0.0, 1.0]]
        )
        east = [-sin(longitude), cos(longitude), 0.0]
        up = [cos(latitude) * cos(longitude), cos(latitude) * sin(longitude), sin(latitude)]
        self._axes = np.column_stack([east, np.cross(up, east), up])
        normal = _A / sqrt(1 - _E2 * sin(latitude) ** 2)
        foot = normal + place.elevation
        self._origin = np.array([foot * up[0], foot * up[1], (normal * (1 - _E2) + place.elevation) * up[2]])

    def east_north_up(self, vector: np.ndarray) -> np.ndarray:
        """Return a vector of the world in the axes east, north, up."""
        return np.array(self._heading @ vector)

    def geodetic(self, position: np.ndarray) -> tuple[float, float, float]:
        """Return latitude and longitude (degrees) and height above the ellipsoid (m) of a position in the world (m).

        Bowring's formula: exact to 1e-9 m near the ground.
        """
        x, y, z = self._origin + self._axes @ self.east_north_up(position)
        across = hypot(x, y)
        angle = atan2(z * _A, across * _B)
        latitude = atan2(
            z + _E2 / (1 - _E2) * _B * sin(angle) ** 3,
            across - _E2 * _A * cos(angle) ** 3,
        )
        normal = _A / sqrt(1 - _E2 * sin(latitude) ** 2)
        height = across * cos(latitude) + z * sin(latitude) - _A**2 / normal
        return degrees(latitude), degrees(atan2(y, x)), height


@sensor("navsat", "gps")
class NavSat(SensorSystem):
    """Measure where on Earth a point of a link is (gz-sim's NavSat system, gz-sensors' src/NavSatSensor.cc).

    .. pydrake_system::

        name: NavSat
        input_ports:
        - body_poses
        - body_spatial_velocities
        output_ports:
        - message
        - velocity

    - ``body_poses``, ``body_spatial_velocities``: the plant's ports of these names.
    - ``message``: ``sensor_msgs/msg/NavSatFix`` of the present time; None in a world without
      ``<spherical_coordinates>``.
    - ``velocity``: ``geometry_msgs/msg/Vector3Stamped``, east, north, up (m/s); Gazebo classic's plugin publishes it.
    """

    message_type = "sensor_msgs/msg/NavSatFix"
    gz_topic = "navsat"

    @classmethod
    def read(cls, element: SensorElement) -> NavSatSettings:
        """Read the noise.

        Raises:
            InputError: If a value is invalid.
        """
        part = element.part("navsat") or element.part("gps")
        noises = {
            f"{direction}{suffix}": read_noise(part, f"{what}/{direction}/noise")
            for what, suffix in (("position_sensing", ""), ("velocity_sensing", "_velocity"))
            for direction in ("horizontal", "vertical")
        }
        return NavSatSettings(noises, element.plugin_kind == "gazebo_ros_gps_sensor")

    @classmethod
    def topics(cls, sensor: Sensor, settings: NavSatSettings, base: str) -> Iterable[SensorTopic]:
        """Return its topic: ``~/out`` and ``~/vel`` of Gazebo classic's plugin."""
        plugin = classic_plugin(sensor, "gazebo_ros_gps_sensor")
        if plugin is None:
            return super().topics(sensor, settings, base)
        named = (("message", cls.message_type, "~/out"), ("velocity", "geometry_msgs/msg/Vector3Stamped", "~/vel"))
        return tuple(SensorTopic(own, kind, classic_topic(plugin, name), is_ros=True) for own, kind, name in named)

    def __init__(self, setup: SensorSetup):
        super().__init__(setup)
        self._motion = PointMotion(self, int(setup.body.index()), setup.pose.translation())
        place = setup.surroundings.spherical
        self._tangent = None if place is None else Tangent(place)
        if place is None:
            self.warnings = ("the world has no <spherical_coordinates>, so it measures nothing",)
        settings: NavSatSettings = setup.settings
        spread = [settings.noises.get(name, SILENT).stddev ** 2 for name in ("horizontal", "horizontal", "vertical")]
        self._covariance = np.diag(spread if settings.is_classic else [0.0] * 3).ravel()
        self.declare_message_output(self._calc)
        self.declare_message_output(self._calc_velocity, own="velocity")

    def _calc(self, context: Context, output: AbstractValue) -> None:
        if self._tangent is None:
            set_value(output, None)
            return
        position, time = self._motion.position(context), context.get_time()
        is_classic = self.setup.settings.is_classic
        if is_classic:  # in metres, before it becomes latitude and longitude
            position = np.append(
                self.noisy("horizontal", position[:2], time), self.noisy("vertical", position[2], time)
            )
        latitude, longitude, height = self._tangent.geodetic(position)
        if not is_classic:
            latitude, longitude = self.noisy("horizontal", np.array([latitude, longitude]), time).tolist()
            height = float(self.noisy("vertical", height, time))
        output.set_value(
            messages.NavSatFix(
                header=self.header(context),
                status=messages.NavSatStatus(status=0, service=int(is_classic)),
                latitude=latitude,
                longitude=longitude,
                altitude=height,
                position_covariance=self._covariance,
                position_covariance_type=_DIAGONAL_KNOWN if is_classic else 0,
            )
        )

    def _calc_velocity(self, context: Context, output: AbstractValue) -> None:
        if self._tangent is None:
            set_value(output, None)
            return
        velocity, time = self._tangent.east_north_up(self._motion.velocity(context)), context.get_time()
        east, north = self.noisy("horizontal_velocity", velocity[:2], time).tolist()
        up = float(self.noisy("vertical_velocity", velocity[2], time))
        output.set_value(
            messages.Vector3Stamped(header=self.header(context), vector=messages.Vector3(x=east, y=north, z=up))
        )
