"""The kinds of sensors: each class registers itself under the types of its ``<sensor>`` tag."""

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

from drake_twin.extensions import Registry

if TYPE_CHECKING:
    from drake_twin.sensors.sensor_system import SensorSystem

_S = TypeVar("_S", bound="type[SensorSystem]")

SENSORS: "Registry[type[SensorSystem]]" = Registry(
    "sensor type", "sensor", "drake_twin.sensors", ["drake_twin.sensors"]
)
sensor_class = SENSORS.get


def sensor(*kinds: str, on: str = "link") -> Callable[[_S], _S]:
    """Register a sensor class under the types of its ``<sensor>`` tag, for example ``imu``.

    Args:
        *kinds: The types. One that begins with ``gazebo_ros_`` is a plugin of Gazebo classic that is a sensor by
            itself.
        on: The element that such a sensor is on: ``link`` or ``joint``.

    Raises:
        InputError: If another class is registered under a type.
    """

    def register(cls: _S) -> _S:
        for kind in kinds:
            SENSORS.add(kind, cls, cls)
        cls.on = on
        return cls

    return register
