"""A range sensor's value as messages, as ros2_controllers' range_sensor_broadcaster publishes it."""

from dataclasses import field
from typing import Any, ClassVar

from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.hardware_sensor_broadcaster import HardwareSensorBroadcaster
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass


@dataclass(frozen=True)
class RangeSensorBroadcasterParameters:
    """Parameters of ``range_sensor_broadcaster/RangeSensorBroadcaster``.

    Attributes:
        sensor_name: The sensor in ``<ros2_control>``.
        frame_id: The frame of the value.
        radiation_type: The sensor's radiation: 0 for ultrasound, 1 for infrared.
        field_of_view: The angle in which the range is valid (rad).
        min_range: The lowest range (m).
        max_range: The highest range (m).
        variance: The variance of the range (m²).
    """

    sensor_name: str = field(metadata={"not_empty": True})
    frame_id: str = field(metadata={"not_empty": True})
    radiation_type: int = 0
    field_of_view: float = 0.52
    min_range: float = 0.52
    max_range: float = 4.0
    variance: float = 0.0


@controller("range_sensor_broadcaster/RangeSensorBroadcaster")
class RangeSensorBroadcaster(HardwareSensorBroadcaster):
    """Publish a range sensor's value as ``Range`` messages.

    Behaves as ``range_sensor_broadcaster/RangeSensorBroadcaster`` in ROS 2 Jazzy: a range outside the bounds is
    published as it is. The twin does not simulate range sensors: the value is the state interface's ``initial_value``
    in ``<ros2_control>``, or NaN.

    .. pydrake_system::

        name: RangeSensorBroadcaster
        input_ports:
        - values
        output_ports:
        - range

    - ``values``: vector ``[range]`` (m).
    - ``range``: ``sensor_msgs/msg/Range`` of the present time, None while inactive; topic ``~/range``.
    """

    Parameters: ClassVar[type] = RangeSensorBroadcasterParameters

    @classmethod
    def state_interfaces(cls, parameters: RangeSensorBroadcasterParameters) -> tuple[str, ...]:
        """Return the range."""
        return (f"{parameters.sensor_name}/range",)

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        self.declare_message_output("range", "sensor_msgs/msg/Range", self._range, self._present())

    def _range(self, context: Context) -> Any:
        parameters: RangeSensorBroadcasterParameters = self.setup.parameters
        return messages.Range(
            header=messages.header(context.get_time(), self.setup.frame(parameters.frame_id)),
            radiation_type=parameters.radiation_type,
            field_of_view=parameters.field_of_view,
            min_range=parameters.min_range,
            max_range=parameters.max_range,
            range=float(self._sensor.Eval(context)[0]),
            variance=parameters.variance,
        )
