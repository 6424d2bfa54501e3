"""An altimeter on a link."""

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.description.sensor_element import SensorElement
from drake_twin.sensors.noise import NoiseSettings, read_noise
from drake_twin.sensors.point_motion import PointMotion
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem


@sensor("altimeter")
class Altimeter(SensorSystem):
    """Measure the height above the start and the vertical velocity (gz-sensors, src/AltimeterSensor.cc).

    .. pydrake_system::

        name: Altimeter
        input_ports:
        - body_poses
        - body_spatial_velocities
        output_ports:
        - message

    - ``body_poses``, ``body_spatial_velocities``: the plant's ports of these names.
    - ``message``: ``ros_gz_interfaces/msg/Altimeter`` (m, m/s) of the present time.
    """

    message_type = "ros_gz_interfaces/msg/Altimeter"
    gz_topic = "altimeter"

    @classmethod
    def read(cls, element: SensorElement) -> NoiseSettings:
        """Read the noise of its height (m) and of its vertical velocity (m/s).

        Raises:
            InputError: If a value is invalid.
        """
        names = ("vertical_position", "vertical_velocity")
        return NoiseSettings({name: read_noise(element, f"altimeter/{name}/noise") for name in names})

    def __init__(self, setup: SensorSetup):
        super().__init__(setup)
        self._reference = float(setup.start.translation()[2])
        self._motion = PointMotion(self, int(setup.body.index()), setup.pose.translation())
        self.declare_message_output(self._calc)

    def _calc(self, context: Context, output: AbstractValue) -> None:
        height = float(self._motion.position(context)[2]) - self._reference
        velocity, time = float(self._motion.velocity(context)[2]), context.get_time()
        output.set_value(
            messages.message(
                self.message_type,
                {
                    "header": self.header(context),
                    "vertical_position": self.noisy("vertical_position", height, time),
                    "vertical_velocity": self.noisy("vertical_velocity", velocity, time),
                    "vertical_reference": self._reference,
                },
            )
        )
