"""A barometer on a link."""

from math import exp, log

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.dataclass import dataclass
from drake_twin.description.sensor_element import SensorElement
from drake_twin.sensors.noise import Noise, read_noise
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem

# The standard atmosphere of 1976 below 11 km, with the constants of gz-sensors.
_SEA_LEVEL, _TEMPERATURE, _LAPSE = 101325.0, 288.15, 0.0065  # Pa, K, K/m
_GRAVITY, _AIR, _GAS, _EARTH = 9.80665, 28.9644, 8314.32, 6356766.0  # m/s², kg/kmol, J/(kmol·K), m


@dataclass(frozen=True)
class AirPressureSettings:
    """What a barometer reads of its element.

    Attributes:
        reference: The altitude of the world's z = 0 (m).
        noises: The noise of its ``pressure`` (Pa).
    """

    reference: float
    noises: dict[str, Noise]


def pressure_at(altitude: float) -> float:
    """Return the pressure of the standard atmosphere (Pa) at an altitude (m)."""
    height = _EARTH * altitude / (_EARTH + altitude)
    exponent = _GRAVITY * _AIR / (_GAS * -_LAPSE)
    return _SEA_LEVEL * exp(exponent * log(_TEMPERATURE / (_TEMPERATURE - _LAPSE * height)))


@sensor("air_pressure")
class AirPressure(SensorSystem):
    """Measure the pressure of the standard atmosphere at the sensor's height (gz-sensors, src/AirPressureSensor.cc).

    .. pydrake_system::

        name: AirPressure
        input_ports:
        - body_poses
        output_ports:
        - message

    - ``body_poses``: the plant's port of this name.
    - ``message``: ``sensor_msgs/msg/FluidPressure`` (Pa) of the present time.
    """

    message_type = "sensor_msgs/msg/FluidPressure"
    gz_topic = "air_pressure"

    @classmethod
    def read(cls, element: SensorElement) -> AirPressureSettings:
        """Read the altitude and the noise.

        Raises:
            InputError: If a value is invalid.
        """
        reference = element.number("air_pressure/reference_altitude", 0.0)
        return AirPressureSettings(reference, {"pressure": read_noise(element, "air_pressure/pressure/noise")})

    def __init__(self, setup: SensorSetup):
        super().__init__(setup)
        self._body, self._p_BS_B = int(setup.body.index()), np.array(setup.pose.translation())
        self._poses = self.declare_plant_input("body_poses")
        self.declare_message_output(self._calc)

    def _calc(self, context: Context, output: AbstractValue) -> None:
        settings: AirPressureSettings = self.setup.settings
        height = float(self._poses.Eval(context)[self._body].multiply(self._p_BS_B)[2])
        pressure = self.noisy("pressure", pressure_at(settings.reference + height), context.get_time())
        variance = settings.noises["pressure"].stddev ** 2
        output.set_value(
            messages.FluidPressure(header=self.header(context), fluid_pressure=pressure, variance=variance)
        )
