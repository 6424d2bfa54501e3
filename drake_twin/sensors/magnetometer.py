"""A magnetometer on a link."""

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.description.sensor_element import SensorElement
from drake_twin.sensors.noise import NoiseSettings, read_noise
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem


@sensor("magnetometer")
class Magnetometer(SensorSystem):
    """Measure the world's ``<magnetic_field>`` in the sensor's own axes (gz-sensors, src/MagnetometerSensor.cc).

    .. pydrake_system::

        name: Magnetometer
        input_ports:
        - body_poses
        output_ports:
        - message

    - ``body_poses``: the plant's port of this name.
    - ``message``: ``sensor_msgs/msg/MagneticField`` (T) of the present time.
    """

    message_type = "sensor_msgs/msg/MagneticField"
    gz_topic = "magnetometer"

    @classmethod
    def read(cls, element: SensorElement) -> NoiseSettings:
        """Read the noise of each axis (T).

        Raises:
            InputError: If a value is invalid.
        """
        return NoiseSettings({axis: read_noise(element, f"magnetometer/{axis}/noise") for axis in "xyz"})

    def __init__(self, setup: SensorSetup):
        super().__init__(setup)
        self._body = int(setup.body.index())
        self._R_BS = setup.pose.rotation()
        self._field = np.array(setup.surroundings.magnetic_field)
        self._poses = self.declare_plant_input("body_poses")
        self.declare_message_output(self._calc)

    def _calc(self, context: Context, output: AbstractValue) -> None:
        R_WS = self._poses.Eval(context)[self._body].rotation() @ self._R_BS
        time = context.get_time()
        measured = zip("xyz", (R_WS.matrix().T @ self._field).tolist(), strict=True)
        field = messages.Vector3(**{axis: self.noisy(axis, value, time) for axis, value in measured})
        output.set_value(
            messages.MagneticField(
                header=self.header(context), magnetic_field=field, magnetic_field_covariance=np.zeros(9)
            )
        )
