"""The base of the broadcasters of sensors: the port of the sensor's values, and activation."""

from collections.abc import Sequence
from typing import Any

from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.sensor_reader import SensorReader
from drake_twin.controllers.stateful_controller import Sample, StatefulController
from drake_twin.errors import InputError


class SensorBroadcaster(SensorReader, StatefulController):
    """Publish the values of one sensor; it claims nothing, and has no events unless a subclass adds one.

    A message is computed on demand and has the present time, so that one computed at the controller's update rate is
    what ros2_control publishes. An inactive broadcaster has no message.
    """

    def __init__(self, setup: ControllerSetup, port: str):
        super().__init__(setup)
        self.declare_sensor_input(port)

    def activate(self, context: Context) -> None:
        """Start at the present time."""
        self.set_sample(context, Sample(active=True, time=context.get_time()))

    def _present(self) -> set[Any]:
        """Return the dependency tickets of a message of the present time, beside that of the activation."""
        return {self.time_ticket(), self.input_port_ticket(self._sensor.get_index())}


def transform_message(time: float, parent: str, child: str, pose: Sequence[float]) -> Any:
    """Return a ``geometry_msgs/msg/TransformStamped`` of a pose x, y, z, qx, qy, qz, qw (m) at a time (s)."""
    transform = messages.Transform(messages.Vector3(*pose[:3]), messages.Quaternion(*pose[3:]))
    return messages.TransformStamped(messages.header(time, parent), child, transform)


def check_covariances(setup: ControllerSetup, *names: str) -> None:
    """Check parameters that are covariances of three components.

    Raises:
        InputError: If one does not have nine numbers.
    """
    for name in names:
        count = len(getattr(setup.parameters, name))
        if count != 9:
            raise InputError(f"controller {setup.name!r}: {name} has {count} numbers, where nine are needed")
