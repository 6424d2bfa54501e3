"""The controller types: each class registers itself, and its module is imported when the type is asked for."""

from collections.abc import Callable
from dataclasses import is_dataclass
from typing import TYPE_CHECKING, TypeVar

from drake_twin.errors import InputError
from drake_twin.extensions import Registry

if TYPE_CHECKING:
    from drake_twin.controllers.base_controller import Controller

_C = TypeVar("_C", bound="type[Controller]")

JOINT_STATE_BROADCASTER = "joint_state_broadcaster/JointStateBroadcaster"

CONTROLLERS: "Registry[type[Controller]]" = Registry(
    "controller type", "controller", "drake_twin.controllers", ["drake_twin.controllers"]
)
controller_class = CONTROLLERS.get


def controller(kind: str) -> Callable[[_C], _C]:
    """Register a controller class under the type that parameters files name.

    Args:
        kind: The plugin's name, for example ``my_pkg/MyController``.

    Raises:
        InputError: If another class is registered under the type, or the class has no dataclass ``Parameters``.
    """

    def register(cls: _C) -> _C:
        if not is_dataclass(getattr(cls, "Parameters", None)):
            raise InputError(f"controller type {kind!r}: {cls.__qualname__} needs a dataclass Parameters")
        CONTROLLERS.add(kind, cls, cls)
        return cls

    return register


def controller_types() -> tuple[str, ...]:
    """Return all controller types in alphabetical order, with those of third parties."""
    return tuple(sorted(CONTROLLERS))
