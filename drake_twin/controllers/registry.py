"""The controller types: each class registers itself, and its module is imported when the type is asked for."""

from collections.abc import Callable
from dataclasses import is_dataclass
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pkgutil import iter_modules
from typing import TYPE_CHECKING, TypeVar

from drake_twin.errors import InputError
from drake_twin.extensions import load_extensions

if TYPE_CHECKING:
    from drake_twin.controllers.base_controller import Controller

_C = TypeVar("_C", bound="type[Controller]")

JOINT_STATE_BROADCASTER = "joint_state_broadcaster/JointStateBroadcaster"

ENTRY_POINTS = "drake_twin.controllers"

_PACKAGE = "drake_twin.controllers"

_classes: "dict[str, type[Controller]]" = {}


def controller(kind: str) -> Callable[[_C], _C]:
    """Register a controller class under the type that parameters files name.

    Args:
        kind: The plugin's name, for example ``my_pkg/MyController``.

    Raises:
        InputError: If another class is registered under the type, or the class has no dataclass ``Parameters``.
    """

    def register(cls: _C) -> _C:
        known = _classes.get(kind, cls)
        if (known.__module__, known.__qualname__) != (cls.__module__, cls.__qualname__):
            raise InputError(f"controller type {kind!r} is registered by {known.__module__} and by {cls.__module__}")
        if not is_dataclass(getattr(cls, "Parameters", None)):
            raise InputError(f"controller type {kind!r}: {cls.__qualname__} needs a dataclass Parameters")
        _classes[kind] = cls
        return cls

    return register


def controller_class(kind: str) -> "type[Controller] | None":
    """Return the class of a controller type; None for an unknown type.

    Looks at the types registered so far, then at this package's modules (a type's own is named like the part before its
    slash), then at the modules that the entry-point group ``drake_twin.controllers`` names.
    """
    if kind not in _classes:
        name = kind.partition("/")[0]
        if name.isidentifier() and find_spec(f"{_PACKAGE}.{name}") is not None:
            import_module(f"{_PACKAGE}.{name}")
    if kind not in _classes:
        _import_own()
    if kind not in _classes:
        load_extensions(ENTRY_POINTS)
    return _classes.get(kind)


def controller_types() -> tuple[str, ...]:
    """Return all controller types in alphabetical order, with those of third parties."""
    _import_own()
    load_extensions(ENTRY_POINTS)
    return tuple(sorted(_classes))


@cache
def _import_own() -> None:
    for module in iter_modules(import_module(_PACKAGE).__path__):
        import_module(f"{_PACKAGE}.{module.name}")
