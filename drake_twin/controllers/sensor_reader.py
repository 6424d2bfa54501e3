"""The base of controllers that read a sensor of ``<ros2_control>``."""

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import InputPort

from drake_twin.description.robot_description import RobotDescription
from drake_twin.sensors.plant_reader import PlantReader

if TYPE_CHECKING:
    from drake_twin.controllers.base_controller import Controller as _Controller
else:
    _Controller = object  # a class may have one base of nanobind at most


class SensorReader(_Controller):
    """Read the state interfaces of a sensor on one vector input port.

    A simulated sensor of the same name sets them, as in gz_ros2_control. Without one they keep their
    ``initial_value`` in ``<ros2_control>``, or NaN, as those of mock hardware that nothing sets.

    Attributes:
        kind: The simulated sensor's kind, as in `drake_twin.description.robot_description.Sensor`.
    """

    kind: ClassVar[str]

    @classmethod
    def sensor_name(cls, parameters: Any) -> str:
        """Return the name of the sensor in ``<ros2_control>`` that the controller reads."""
        name: str = parameters.sensor_name
        return name

    @classmethod
    def state_interfaces(cls, parameters: Any) -> tuple[str, ...]:
        """Return the state interface (``sensor/interface``) of each element of the sensor's port."""
        raise NotImplementedError

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return why the robot's sensor cannot be read; None if it can."""
        name = cls.sensor_name(parameters)
        if description.sensor(name, cls.kind) is not None or name in description.hardware_sensors:
            return None
        known = ", ".join(sensor.name for sensor in description.sensors if sensor.kind == cls.kind) or "none"
        return f"the robot has no {cls.kind} sensor {name!r} for Gazebo (it has {known})"

    def num_values(self) -> int:
        """Return the size of the port of the values."""
        return len(self.state_interfaces(self.setup.parameters))

    def declare_sensor_input(self, name: str) -> InputPort:
        """Declare the vector input port of the sensor's values."""
        self._sensor: InputPort = self.DeclareVectorInputPort(name, self.num_values())
        return self._sensor

    def get_sensor_input_port(self) -> InputPort:
        """Return the port of the sensor's values."""
        return self._sensor

    @property
    def simulated_sensor(self) -> tuple[str, str]:
        """The name and the kind of the robot's sensor that it reads, if the robot has it."""
        return self.sensor_name(self.setup.parameters).strip("/"), self.kind

    def own_sensor(self, plant: MultibodyPlant, instance: ModelInstanceIndex) -> PlantReader | None:
        """Return a new system that measures the values in a finalized plant; None if no such system is needed."""
        return None

    def initial_values(self) -> np.ndarray:
        """Return the value of each state interface that nothing sets: its ``initial_value``, or NaN."""
        states = self.setup.description.sensor_states
        return np.array([states.get(name, np.nan) for name in self.state_interfaces(self.setup.parameters)])
