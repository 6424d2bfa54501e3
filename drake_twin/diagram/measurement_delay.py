"""The delay of what a robot's controllers read."""

from math import ceil

from pydrake.systems.framework import DiagramBuilder, InputPort, OutputPort
from pydrake.systems.primitives import DiscreteTimeDelay

from drake_twin.diagram.plant_inputs import PlantInputs, free_name


class MeasurementDelay:
    """Connects controllers to the plant's ports through delays, or directly where the delay is zero.

    A delay keeps the values of the last physics steps, in Drake's C++. Messages and updates see it before it takes the
    value of the present step, so that one of n steps has n values, the oldest first.

    Args:
        builder: The builder of the robot's sub-diagram.
        inputs: Its ports that take what the plant outputs.
        delay: The delay (s); it is rounded up to whole steps.
        time_step: The physics step (s).

    Attributes:
        systems: The plant's port → the system that delays it.
    """

    def __init__(self, builder: DiagramBuilder, inputs: PlantInputs, delay: float, time_step: float):
        self._builder, self._inputs = builder, inputs
        self._steps, self._time_step = ceil(delay / time_step - 1e-6), time_step
        self.systems: dict[str, DiscreteTimeDelay] = {}

    def connect(self, output: OutputPort, name: str, port: InputPort) -> None:
        """Connect a controller's port to an output port of the plant.

        Args:
            output: The plant's port.
            name: The name of the sub-diagram's input port.
            port: The controller's port.
        """
        if not self._steps or not output.size():
            self._inputs.connect(output, name, port)
            return
        if name not in self.systems:
            delay = DiscreteTimeDelay(self._time_step, self._steps - 1, output.size())
            self.systems[name] = self._builder.AddNamedSystem(free_name(self._builder, f"{name}_delay"), delay)
            self._inputs.connect(output, name, delay.get_input_port())
        self._builder.Connect(self.systems[name].get_output_port(), port)
