"""The older accessors of controllers' ports, ``get_imu_output_port()`` for ``GetOutputPort("imu")``."""

import warnings
from typing import Any, TypeVar

C = TypeVar("C", bound=type)

_PORTS = {
    "input": (
        "follow_joint_trajectory",
        "gpio_states",
        "gripper_cmd",
        "joint_references",
        "spatial",
        "values",
        "wrench",
        "wrench_reference",
    ),
    "output": (
        "battery_state",
        "controller_state",
        "fix",
        "imu",
        "magnetic_field",
        "odom",
        "pose",
        "range",
        "raw_battery_states",
        "status",
        "wrench",
        "wrench_filtered",
    ),
}


def with_older_accessors(controller: C) -> C:
    """Give a class of systems the older accessors, of the ports that a system has; they warn.

    They are looked up in the class: a system with a ``__getattr__`` would be asked by Drake in each step, for methods
    that it looks for in Python.
    """
    for direction, ports in _PORTS.items():
        for port in ports:
            name = f"get_{port}_{direction}_port"
            if name not in vars(controller):
                setattr(controller, name, _accessor(name, port, direction.title()))
    return controller


def _accessor(name: str, port: str, direction: str) -> property:
    get = f"Get{direction}Port"

    def accessor(self: Any) -> Any:
        if not getattr(self, f"Has{direction}Port")(port):
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}", name=name, obj=self)

        def call() -> Any:
            warnings.warn(f"{name}() is an older name of {get}({port!r})", DeprecationWarning, stacklevel=2)
            return getattr(self, get)(port)

        return call

    return property(accessor)
