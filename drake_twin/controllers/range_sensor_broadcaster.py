"""A range sensor's value as messages, as ros2_controllers' range_sensor_broadcaster publishes it."""

from dataclasses import dataclass
from typing import ClassVar

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context, InputPort, OutputPort

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.hardware_sensor_broadcaster import HardwareSensorBroadcaster, check_given
from drake_twin.controllers.registry import controller
from drake_twin.systems.no_message import set_value


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

    sensor_name: str
    frame_id: str
    radiation_type: int = 0
    field_of_view: float = 0.52
    min_range: float = 0.52
    max_range: float = 4.0
    variance: float = 0.0

    def __post_init__(self) -> None:
        check_given(self, "sensor_name", "frame_id")


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
        super().__init__(setup, "values")
        self.declare_topic_output("range", "sensor_msgs/msg/Range", self._calc_range, self._present())

    def get_values_input_port(self) -> InputPort:
        """Return the port ``values``."""
        return self.get_sensor_input_port()

    def get_range_output_port(self) -> OutputPort:
        """Return the port ``range``."""
        return self.GetOutputPort("range")

    def _calc_range(self, context: Context, output: AbstractValue) -> None:
        if not self.sample(context).active:
            set_value(output, None)
            return
        parameters: RangeSensorBroadcasterParameters = self.setup.parameters
        output.set_value(
            messages.Range(
                header=messages.header(context.get_time(), self.setup.frame(parameters.frame_id)),
                radiation_type=parameters.radiation_type,
                field_of_view=parameters.field_of_view,
                min_range=parameters.min_range,
                max_range=parameters.max_range,
                range=float(self._sensor.Eval(context)[0]),
                variance=parameters.variance,
            )
        )
