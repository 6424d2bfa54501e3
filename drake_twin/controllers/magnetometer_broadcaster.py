"""A magnetometer's values as messages, as ros2_controllers' magnetometer_broadcaster publishes them."""

from dataclasses import field
from typing import Any, ClassVar

import numpy as np
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.hardware_sensor_broadcaster import HardwareSensorBroadcaster
from drake_twin.controllers.registry import controller
from drake_twin.controllers.sensor_broadcaster import check_covariances
from drake_twin.dataclass import dataclass


@dataclass(frozen=True)
class MagnetometerBroadcasterParameters:
    """Parameters of ``magnetometer_broadcaster/MagnetometerBroadcaster``.

    Attributes:
        sensor_name: The sensor in ``<ros2_control>``.
        frame_id: The frame of the values.
        static_covariance: Nine numbers, row by row (T²).
    """

    read_only: ClassVar[tuple[str, ...]] = ("*",)

    sensor_name: str = field(metadata={"not_empty": True})
    frame_id: str = field(metadata={"not_empty": True})
    static_covariance: tuple[float, ...] = (0.0,) * 9


@controller("magnetometer_broadcaster/MagnetometerBroadcaster")
class MagnetometerBroadcaster(HardwareSensorBroadcaster):
    """Publish a magnetometer's values as ``MagneticField`` messages.

    Behaves as ``magnetometer_broadcaster/MagnetometerBroadcaster`` in ROS 2 Jazzy. The twin does not simulate magnetic
    fields: the values are the state interfaces' ``initial_value`` in ``<ros2_control>``, or NaN.

    .. pydrake_system::

        name: MagnetometerBroadcaster
        input_ports:
        - values
        output_ports:
        - magnetic_field

    - ``values``: vector ``[bx by bz]`` (T).
    - ``magnetic_field``: ``sensor_msgs/msg/MagneticField`` of the present time, None while inactive; topic
      ``~/magnetic_field``.
    """

    Parameters: ClassVar[type] = MagnetometerBroadcasterParameters

    @classmethod
    def state_interfaces(cls, parameters: MagnetometerBroadcasterParameters) -> tuple[str, ...]:
        """Return the field's components."""
        return tuple(f"{parameters.sensor_name}/magnetic_field.{axis}" for axis in "xyz")

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        check_covariances(setup, "static_covariance")
        kind = "sensor_msgs/msg/MagneticField"
        self.declare_message_output("magnetic_field", kind, self._magnetic_field, self._present())

    def _magnetic_field(self, context: Context) -> Any:
        parameters: MagnetometerBroadcasterParameters = self.setup.parameters
        return messages.MagneticField(
            header=messages.header(context.get_time(), self.setup.frame(parameters.frame_id)),
            magnetic_field=messages.Vector3(*self._sensor.Eval(context).tolist()),
            magnetic_field_covariance=np.array(parameters.static_covariance),
        )
