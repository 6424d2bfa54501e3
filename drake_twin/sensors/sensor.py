"""The base of all sensors of a robot."""

from typing import ClassVar, Self

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import InputPort, OutputPort

from drake_twin.description.robot_description import Sensor
from drake_twin.systems.witnessless_system import WitnesslessSystem


class SensorSystem(WitnesslessSystem):
    """Turn the plant's ports into one vector of measured values.

    Attributes:
        size: The number of its values.
    """

    size: ClassVar[int]

    @classmethod
    def of(cls, plant: MultibodyPlant, instance: ModelInstanceIndex, sensor: Sensor) -> Self:
        """Return the sensor of a robot in a finalized plant, whose defaults are the robot's start state."""
        raise TypeError(f"{cls.__name__} cannot be made from a <sensor> tag: define of()")

    def inputs_from(self, plant: MultibodyPlant) -> tuple[tuple[OutputPort, InputPort], ...]:
        """Return pairs of the plant's output ports and this system's input ports to connect."""
        return ()
