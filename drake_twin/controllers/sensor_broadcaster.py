"""The base of the broadcasters of sensors: the port of the sensor's values, and activation."""

from dataclasses import replace
from typing import Any, ClassVar

from pydrake.systems.framework import Context, InputPort

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.stateful_controller import Sample, StatefulController
from drake_twin.description.robot_description import RobotDescription


class SensorBroadcaster(StatefulController):
    """Publish the values of one sensor; it claims nothing, and has no events unless a subclass adds one.

    A message is computed on demand and has the present time, so that one computed at the controller's update rate is
    what ros2_control publishes. An inactive broadcaster has no message.

    Attributes:
        kind: The sensor's kind, as in `drake_twin.description.robot_description.Sensor`.
    """

    kind: ClassVar[str]

    @classmethod
    def sensor_name(cls, parameters: Any) -> str:
        """Return the name of the sensor in ``<ros2_control>`` that the controller reads."""
        name: str = parameters.sensor_name
        return name

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return why the robot's sensor cannot be broadcast; None if it can."""
        name = cls.sensor_name(parameters)
        if description.sensor(name, cls.kind) is not None or name in description.hardware_sensors:
            return None
        known = ", ".join(sensor.name for sensor in description.sensors if sensor.kind == cls.kind) or "none"
        return f"the robot has no {cls.kind} sensor {name!r} for Gazebo (it has {known})"

    def __init__(self, setup: ControllerSetup, port: str, size: int):
        super().__init__(setup)
        self._sensor = self.DeclareVectorInputPort(port, size)

    def get_sensor_input_port(self) -> InputPort:
        """Return the port of the sensor's values."""
        return self._sensor

    def activate(self, context: Context) -> None:
        """Start at the present time."""
        self.set_sample(context, Sample(active=True, time=context.get_time()))

    def deactivate(self, context: Context) -> None:
        """Stop publishing."""
        self.set_sample(context, replace(self.sample(context), active=False))

    def _present(self) -> set[Any]:
        """Return the dependency tickets of a message of the present time."""
        return {self.time_ticket(), self.input_port_ticket(self._sensor.get_index()), self.sample_ticket()}
