"""The kinds of sensors: each class registers itself under the type of its ``<sensor>`` tag."""

from collections.abc import Callable
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from drake_twin.sensors.sensor import SensorSystem

_S = TypeVar("_S", bound="type[SensorSystem]")

ENTRY_POINTS = "drake_twin.sensors"

_classes: "dict[str, type[SensorSystem]]" = {}


def sensor(kind: str) -> Callable[[_S], _S]:
    """Register a sensor class under the type of its ``<sensor>`` tag, for example ``imu``.

    Raises:
        ValueError: If another class is registered under the type.
    """

    def register(cls: _S) -> _S:
        known = _classes.get(kind, cls)
        if (known.__module__, known.__qualname__) != (cls.__module__, cls.__qualname__):
            raise ValueError(f"sensor type {kind!r} is registered by {known.__module__} and by {cls.__module__}")
        _classes[kind] = cls
        return cls

    return register


def sensor_class(kind: str) -> "type[SensorSystem]":
    """Return the class of a sensor type.

    Raises:
        KeyError: If the type is unknown.
    """
    if kind not in _classes:
        _import_all()
    return _classes[kind]


@cache
def _import_all() -> None:
    from importlib.metadata import entry_points

    for module in iter_modules(import_module(__package__).__path__):
        import_module(f"{__package__}.{module.name}")
    for point in entry_points(group=ENTRY_POINTS):
        point.load()
