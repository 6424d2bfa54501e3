"""Modules for ROS's running graph, which launch files import and seldom use: rclpy, messages and the like.

An import never fails. A message can be made; a node cannot, and says so when it is.
"""

import importlib.abc
import importlib.machinery
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

from drake_twin.ros2.launch.logging import get_logger
from drake_twin.ros2.packages import AbsentError

_INTERFACES = ("_msgs", "_srvs", "_interfaces")
_KINDS = ("msg", "srv", "action")
_OF_THE_GRAPH = frozenset(
    (
        *("rclpy", "tf2_ros", "tf2_py", "tf2_geometry_msgs", "rosidl_runtime_py", "sensor_msgs_py", "cv_bridge"),
        *(
            "tf2_sensor_msgs",
            "laser_geometry",
            "image_geometry",
            "message_filters",
            "rosbag2_py",
            "ros2cli",
            "ros2node",
        ),
        *("ros2node", "ros2topic", "ros2param", "ros2lifecycle"),
    )
)


class _Interface:
    """A message, service or action: its fields are attributes, made when they are asked for."""

    def __init__(self, **fields: Any):
        self.__dict__.update(fields)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        value = _Interface()
        setattr(self, name, value)
        return value


class _Open(type):
    """Has members that are like it: `rclpy.task.Future` and the like stand in annotations."""

    def __getattr__(cls, name: str) -> type:
        if name.startswith("__"):
            raise AttributeError(name)
        return _made(name, _OfGraph, f"{cls.__module__}.{cls.__name__}")


class _OfGraph(metaclass=_Open):
    """A class or function that needs a running graph."""

    def __init__(self, *arguments: Any, **keywords: Any):
        raise AbsentError(
            f"the launch file's code uses {type(self).__module__}.{type(self).__name__}, which needs a running ROS"
        )


def _nothing(*arguments: Any, **keywords: Any) -> None:
    """Do nothing, where no node is there that it would matter to."""


_KNOWN: dict[str, Callable[..., Any]] = {
    "rclpy.init": _nothing,
    "rclpy.shutdown": _nothing,
    "rclpy.ok": lambda *arguments, **keywords: False,
    "rclpy.logging.get_logger": get_logger,
}


# The modules of rclpy that ``import rclpy`` makes attributes.
_MODULES = (
    "action",
    "callback_groups",
    "clock",
    "duration",
    "executors",
    "logging",
    "node",
    "parameter",
    "qos",
    "time",
)


def _made(name: str, base: type, module: str) -> type:
    """Return a class of a module, with what services and actions hold."""
    parts = ("Request", "Response", "Goal", "Result", "Feedback") if base is _Interface else ()
    return type(base)(name, (base,), {"__module__": module, **{part: type(part, (base,), {}) for part in parts}})


def is_graph_module(name: str) -> bool:
    """Return whether a module is of the running graph, by its name."""
    root, _, rest = name.partition(".")
    if root in _OF_THE_GRAPH:
        return True
    return root.endswith(_INTERFACES) and (not rest or rest.partition(".")[0] in _KINDS)


class GraphFinder(importlib.abc.MetaPathFinder):
    """Finds the modules, after everything else."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Return a module's spec; None for one that has nothing to do with the graph."""
        if not is_graph_module(fullname):
            return None
        return importlib.machinery.ModuleSpec(fullname, _Loader(), is_package=True)


class _Loader(importlib.abc.Loader):
    def exec_module(self, module: ModuleType) -> None:
        base = _OfGraph if module.__name__.partition(".")[0] in _OF_THE_GRAPH else _Interface

        def attribute(name: str) -> Any:
            full = f"{module.__name__}.{name}"
            if name.startswith("__"):
                raise AttributeError(name)
            if name in _KINDS or (base is _OfGraph and name in _MODULES):
                return importlib.import_module(full)
            value = _KNOWN.get(full) or _made(name, base, module.__name__)
            setattr(module, name, value)
            return value

        module.__getattr__ = attribute  # type: ignore[method-assign]
