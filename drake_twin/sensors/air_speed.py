"""An air speed sensor on a link: a Pitot tube."""

from math import copysign

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.description.sensor_element import SensorElement
from drake_twin.sensors.noise import NoiseSettings, read_noise
from drake_twin.sensors.point_motion import PointMotion
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem

# The standard atmosphere below 11 km, with the constants of gz-sensors.
_DENSITY, _TEMPERATURE, _LAPSE, _EXPONENT = 1.225, 288.15, 0.0065, 4.256  # kg/m³, K, K/m
_HECTO = 100.0


def density_at(altitude: float) -> float:
    """Return the density of the standard atmosphere (kg/m³) at an altitude (m), as gz-sensors computes it."""
    return float(_DENSITY * ((_TEMPERATURE - _LAPSE * altitude) / _TEMPERATURE) ** _EXPONENT)


@sensor("air_speed")
class AirSpeed(SensorSystem):
    """Measure the dynamic pressure of the flow along the sensor's x axis (gz-sensors, src/AirSpeedSensor.cc).

    It is that of the present wind, where gz-sim 10 takes the wind that WindEffects is to reach. ros_gz has no type for
    it: the pressure is published as MAVROS does.

    .. pydrake_system::

        name: AirSpeed
        input_ports:
        - body_poses
        - body_spatial_velocities
        - wind
        output_ports:
        - message

    - ``body_poses``, ``body_spatial_velocities``: the plant's ports of these names.
    - ``wind``: ``geometry_msgs/msg/Vector3``, the velocity of the air in the world (m/s), where that changes.
    - ``message``: ``sensor_msgs/msg/FluidPressure``: half the density times the square of the speed (Pa), negative for
      a flow from behind, of the present time.
    """

    message_type = "sensor_msgs/msg/FluidPressure"
    gz_topic = "air_speed"

    @classmethod
    def read(cls, element: SensorElement) -> NoiseSettings:
        """Read the noise of its pressure, which gz-sensors adds in hPa.

        Raises:
            InputError: If a value is invalid.
        """
        return NoiseSettings({"pressure": read_noise(element, "air_speed/pressure/noise")})

    def __init__(self, setup: SensorSetup):
        super().__init__(setup)
        self._body, self._ahead = int(setup.body.index()), np.array(setup.pose.rotation().matrix()[:, 0])
        self._motion = PointMotion(self, self._body, setup.pose.translation())
        self._poses = self.declare_plant_input("body_poses")
        self._wind = self.host.declare_wind_input() if setup.wind is None else None
        self.declare_message_output(self._calc)

    def _calc(self, context: Context, output: AbstractValue) -> None:
        wind = self.setup.wind
        if self._wind is not None:
            found = self._wind.Eval(context)
            wind = found.x, found.y, found.z
        forward = self._poses.Eval(context)[self._body].rotation().multiply(self._ahead)
        speed = float(forward @ (self._motion.velocity(context) - wind))
        density = density_at(float(self._motion.position(context)[2]))
        pressure = copysign(0.5 * density * speed * speed, speed) / _HECTO
        pressure = _HECTO * self.noisy("pressure", pressure, context.get_time())
        variance = (_HECTO * self.setup.settings.noises["pressure"].stddev) ** 2
        output.set_value(
            messages.FluidPressure(header=self.header(context), fluid_pressure=pressure, variance=variance)
        )
