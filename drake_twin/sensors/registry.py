"""The kinds of sensors: each class registers itself under the types of its ``<sensor>`` tag."""

from collections.abc import Callable
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING, TypeVar

from drake_twin.extensions import load_extensions

if TYPE_CHECKING:
    from drake_twin.sensors.sensor_system import SensorSystem

_S = TypeVar("_S", bound="type[SensorSystem]")

ENTRY_POINTS = "drake_twin.sensors"

_classes: "dict[str, type[SensorSystem]]" = {}


def sensor(*kinds: str, on: str = "link") -> Callable[[_S], _S]:
    """Register a sensor class under the types of its ``<sensor>`` tag, for example ``imu``.

    Args:
        *kinds: The types. One that begins with ``gazebo_ros_`` is a plugin of Gazebo classic that is a sensor by
            itself.
        on: The element that such a sensor is on: ``link`` or ``joint``.

    Raises:
        ValueError: If another class is registered under a type.
    """

    def register(cls: _S) -> _S:
        for kind in kinds:
            known = _classes.get(kind, cls)
            if (known.__module__, known.__qualname__) != (cls.__module__, cls.__qualname__):
                raise ValueError(f"sensor type {kind!r} is registered by {known.__module__} and by {cls.__module__}")
            _classes[kind] = cls
        cls.on = on
        return cls

    return register


def sensor_class(kind: str) -> "type[SensorSystem] | None":
    """Return the class of a sensor type; None for an unknown type."""
    if kind not in _classes:
        _import_all()
    return _classes.get(kind)


def sensor_kinds() -> tuple[str, ...]:
    """Return all sensor types in alphabetical order, with those of third parties."""
    _import_all()
    return tuple(sorted(_classes))


@cache
def _import_all() -> None:
    for module in iter_modules(import_module(__package__).__path__):
        import_module(f"{__package__}.{module.name}")
    load_extensions(ENTRY_POINTS)
