"""The system that has the ports of many sensors."""

from collections.abc import Iterator
from typing import Any

from pydrake.systems.framework import Diagram, InputPort

from drake_twin.sensors.plant_reader import PlantReader
from drake_twin.systems.no_message import empty_value


class SensorHost(PlantReader):
    """Have the ports of many sensors.

    In each physics step Drake visits every system and tells its input ports that they have changed: as 72 systems, the
    sensors of eight robots slowed the steps of a simple scene by 28 %, though nobody listened to them.

    Attributes:
        sensors: The sensors (each a `SensorSystem`); their ports' callbacks hold them weakly.
        shared: What some of them share, by what it is.
        wind_input: The port ``wind``; None where none of them needs it.
    """

    def __init__(self) -> None:
        super().__init__()
        self.sensors: list[Any] = []
        self.shared: dict[Any, Any] = {}
        self.wind_input: InputPort | None = None

    def declare_wind_input(self) -> InputPort:
        """Declare the port ``wind``, for a wind that changes as a ``geometry_msgs/msg/Vector3``, or return it."""
        if self.wind_input is None:
            self.wind_input = self.DeclareAbstractInputPort("wind", empty_value())
        return self.wind_input

    def forget(self) -> None:
        """Forget the sensors, which refer to this system, so that it can be freed; it cannot be used afterwards."""
        self.sensors.clear()
        self.shared.clear()


def sensor_hosts(diagram: Diagram) -> Iterator[SensorHost]:
    """Yield the systems of a diagram that have the ports of sensors."""
    for system in diagram.GetSystems():
        if isinstance(system, SensorHost):
            yield system
        elif isinstance(system, Diagram):
            yield from sensor_hosts(system)
