"""Controllers of ros2_controllers: one kind, one file, registered by `controller`.

To write your own controller, start with::

    from drake_twin.controllers import ControllerSetup, Interface, PeriodicController, Update, controller
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from drake_twin.controllers.registry import controller

if TYPE_CHECKING:
    from drake_twin.controllers.base_controller import Controller, ControllerSetup
    from drake_twin.controllers.interface import Interface
    from drake_twin.controllers.periodic_controller import PeriodicController, Update

_HOMES = {
    "Controller": "base_controller",
    "ControllerSetup": "base_controller",
    "Interface": "interface",
    "PeriodicController": "periodic_controller",
    "Update": "periodic_controller",
}

__all__ = ["Controller", "ControllerSetup", "Interface", "PeriodicController", "Update", "controller"]

if not TYPE_CHECKING:  # else every name that is not there would have the type Any

    def __getattr__(name: str) -> Any:
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
