"""The base of all sensors of a robot."""

from collections.abc import Callable, Collection
from typing import Any, ClassVar, Self

from pydrake.common.value import AbstractValue
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import Context, InputPort, OutputPort

from drake_twin.description.robot_description import Sensor
from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem


class SensorSystem(WitnesslessSystem):
    """A sensor: a LeafSystem that measures what the plant's ports carry.

    One that a broadcaster of ros2_control publishes has one vector output port. One that publishes its own topic, as
    Gazebo's sensors do, has a ``message_type`` and declares its port with `declare_message_output`.

    Attributes:
        size: The number of values of the vector port.
        message_type: The ROS type of its topic; None for a sensor that needs a broadcaster.
    """

    size: ClassVar[int] = 0
    message_type: ClassVar[str | None] = None

    @classmethod
    def of(cls, plant: MultibodyPlant, instance: ModelInstanceIndex, sensor: Sensor) -> Self:
        """Return the sensor of a robot in a finalized plant, whose defaults are the robot's start state."""
        raise TypeError(f"{cls.__name__} does not say how it is made of a <sensor> tag: define of()")

    def inputs_from(self, plant: MultibodyPlant) -> tuple[tuple[OutputPort, InputPort], ...]:
        """Return pairs of one of the plant's output ports and the input port of this system that takes it."""
        return ()

    def declare_message_output(
        self, calc: Callable[[Context, AbstractValue], None], prerequisites: Collection[Any]
    ) -> OutputPort:
        """Declare the output port ``message``, set by ``calc(context, output)``."""
        return self.DeclareAbstractOutputPort(
            "message", lambda: AbstractValue.Make(None), weakly(calc), set(prerequisites)
        )
