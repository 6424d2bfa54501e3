"""The ports of a robot's sub-diagram that take what the plant and the scene graph output."""

from pydrake.systems.framework import DiagramBuilder, InputPort, OutputPort


class PlantInputs:
    """Export an input port for each port of the plant that a system of the robot needs.

    Attributes:
        needed: Input port → the plant's output port.
    """

    def __init__(self, builder: DiagramBuilder):
        self._builder = builder
        self.needed: dict[str, OutputPort] = {}

    def connect(self, output: OutputPort, name: str, port: InputPort) -> None:
        """Connect a system's port to an output port of the plant.

        Args:
            output: The plant's port.
            name: The name of the sub-diagram's input port.
            port: The port of a system in the sub-diagram.
        """
        if name in self.needed:
            self._builder.ConnectInput(name, port)
        else:
            self._builder.ExportInput(port, name)
            self.needed[name] = output


def free_name(builder: DiagramBuilder, name: str) -> str:
    """Return a name that no system has: Drake ends the process if two systems have the same one."""
    while builder.HasSubsystemNamed(name):
        name += "_"
    return name
