"""What the broadcasters of sensors share: the port that carries the sensor's values, and whether they are active."""

from dataclasses import replace
from typing import Any, ClassVar

from pydrake.systems.framework import Context, InputPort

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.stateful_controller import Sample, StatefulController
from drake_twin.description.robot_description import RobotDescription


class SensorBroadcaster(StatefulController):
    """A broadcaster of one sensor's values: it claims nothing, and has no events unless a subclass adds one.

    A message is computed when it is asked for and has the present time, so one that is asked for at the controller's
    update rate is what ros2_control publishes. While the broadcaster is not active there is no message.

    Attributes:
        kind: The kind of the sensor, as `drake_twin.description.robot_description.Sensor` has it.
    """

    kind: ClassVar[str]

    @classmethod
    def sensor_name(cls, parameters: Any) -> str:
        """Return the name of the sensor in ``<ros2_control>`` whose values it needs."""
        name: str = parameters.sensor_name
        return name

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return why the robot's sensor cannot be broadcast; None when it can."""
        name = cls.sensor_name(parameters)
        if description.sensor(name, cls.kind) is not None or name in description.hardware_sensors:
            return None
        known = ", ".join(sensor.name for sensor in description.sensors if sensor.kind == cls.kind) or "none"
        return f"the robot has no {cls.kind} sensor {name!r} for Gazebo (it has {known})"

    def __init__(self, setup: ControllerSetup, port: str, size: int):
        super().__init__(setup)
        self._sensor = self.DeclareVectorInputPort(port, size)

    def get_sensor_input_port(self) -> InputPort:
        """The port that carries the sensor's values."""
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
