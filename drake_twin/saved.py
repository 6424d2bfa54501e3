"""Classes whose values stand in saved files and in state hashes, by a registered name and version."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TypeVar

_T = TypeVar("_T", bound=type)

_classes: dict[str, type] = {}
_names: dict[type, str] = {}

# Name and version, as files have them (``Sample@1``) → class.
SAVED_CLASSES: Mapping[str, type] = MappingProxyType(_classes)


def saved(name: str, version: int = 1) -> Callable[[_T], _T]:
    """Register a frozen dataclass or named tuple, so that its values can be saved.

    Args:
        name: The name in files. It outlives renamed classes and moved modules.
        version: A higher one when the fields change in a way that old values do not fit.

    Raises:
        ValueError: If another class has the name and version.
    """

    def register(kind: _T) -> _T:
        full = f"{name}@{version}"
        known = _classes.get(full, kind)
        if (known.__module__, known.__qualname__) != (kind.__module__, kind.__qualname__):
            raise ValueError(f"two classes are saved as {full}: {known.__module__} and {kind.__module__}")
        _classes[full] = kind
        _names[kind] = full
        return kind

    return register


def saved_name(kind: type) -> str:
    """Return the name and version that a class is saved under.

    Raises:
        TypeError: If the class is not registered.
    """
    if kind not in _names:
        raise TypeError(f"values of {kind.__module__}.{kind.__qualname__} cannot be saved: register it with @saved")
    return _names[kind]
