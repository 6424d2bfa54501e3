"""The modules of this package's tree that stand in for ROS's Python packages."""

import importlib
from collections.abc import Iterable, Mapping
from collections.abc import Set as AbstractSet
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

from drake_twin.nodes.task import here

_FOLDER = Path(__file__).parent
_OF_LAUNCH_FILES = frozenset(("tf_transformations",))  # packages of `drake_twin.ros2` that node programs have, too
_WITHOUT_A_LIST = ("rclpy._rclpy_pybind11", "rclpy.clock_type", "rclpy.impl", "rclpy.type_hash")
_ALWAYS = frozenset(  # what ``import rclpy`` loads, so that it is a member of ``rclpy``
    (
        *("constants", "context", "destroyable", "exceptions", "guard_condition", "impl", "parameter", "signals"),
        *("task", "utilities", "_rclpy_pybind11"),
    )
)
# What ``import rclpy.node`` loads, so that ``rclpy.qos`` is there from then on, and what imports it (rclpy 7.1).
_WITH_NODES = frozenset(
    (
        *("callback_groups", "client", "clock", "clock_type", "duration", "event_handler", "executors"),
        *("expand_topic_name", "logging", "logging_service", "node", "parameter_service", "publisher", "qos"),
        *("qos_overriding_options", "service", "service_introspection", "subscription", "time", "time_source"),
        *("timer", "topic_endpoint_info", "type_description_service", "type_hash", "type_support"),
        *("validate_full_topic_name", "validate_namespace", "validate_node_name", "validate_parameter_name"),
        *("validate_topic_name", "waitable"),
    )
)
_IMPORTING_NODES = frozenset(
    ("node", "action", "lifecycle", "parameter_client", "parameter_event_handler", "wait_for_message")
)
ROOTS = _OF_LAUNCH_FILES | {file.parent.name for file in _FOLDER.glob("*/__init__.py")}

_LAUNCH = frozenset(("launch", "launch_ros", "launch_xml", "launch_yaml", "moveit_configs_utils", "nav2_common"))
YIELDING = frozenset(("nav2_simple_commander", "interactive_markers"))  # to a workspace that has their sources


@cache
def stand_in(name: str) -> ModuleType | None:
    """Return the module of this package's tree that stands in for one of ROS's: ``rclpy.node`` is ``rclpy/node.py``.

    Raises:
        ModuleNotFoundError: If the tree lacks a module of a package that it has.
    """
    root = name.partition(".")[0]
    if root in _OF_LAUNCH_FILES:
        return importlib.import_module(f"drake_twin.ros2.{name}")
    if root in _LAUNCH:
        return _module_of_launch_files(name)
    if root not in ROOTS:
        return None
    if root == "rclpy" and name not in exports() and name not in _WITHOUT_A_LIST:
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)
    path = _FOLDER.joinpath(*name.split("."))
    if not path.with_suffix(".py").is_file() and not (path / "__init__.py").is_file():
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)
    own = importlib.import_module(f"{__package__}.{name}")
    names = exports().get(name)
    return own if names is None else _view(name, own, names)


@cache
def exports() -> Mapping[str, Mapping[str, str]]:
    """Return the names that ROS's modules have: module → name → the module that it comes from.

    A line of ``exports.txt`` has those of a module, for example ``rclpy.action: ActionClient Node@rclpy.node``.
    """
    found: dict[str, dict[str, str]] = {}
    for line in (_FOLDER / "exports.txt").read_text(encoding="utf-8").splitlines():
        module, _, names = line.partition(":")
        pairs = (name.partition("@") for name in names.split())
        found[module] = {name: source or module for name, _, source in pairs}
    return found


def _is_open(module: ModuleType, name: str) -> bool:
    """Return whether a module makes its names itself, or a name is a module of it that has been imported meanwhile."""
    return "__getattr__" in vars(module) or isinstance(vars(module).get(name), ModuleType)


def _view(name: str, own: ModuleType, names: Mapping[str, str]) -> ModuleType:
    """Return a module with ROS's names only, which are looked up once they are asked for."""
    view = ModuleType(name, own.__doc__)
    vars(view).update({key: value for key, value in vars(own).items() if key in ("__file__", "__path__", "__spec__")})

    more = {key for key, value in vars(own).items() if "__all__" in vars(own) or isinstance(value, ModuleType)}

    modules = {
        key.split(".")[1] for key in (*exports(), *_WITHOUT_A_LIST) if name == "rclpy" and key.startswith("rclpy.")
    }

    def attribute(wanted: str) -> Any:
        source = names.get(wanted)
        if wanted in modules and source is None:
            if wanted in _loaded():
                return stand_in(f"rclpy.{wanted}")
            raise AttributeError(f"module {name!r} has no attribute {wanted!r}")
        if source is not None and source != name:
            home = importlib.import_module(source if source in ("typing", "threading") else f"{__package__}.{source}")
            value = getattr(home, wanted)
        elif source is not None or wanted.startswith("_") or wanted in more or _is_open(own, wanted):
            value = getattr(own, wanted)
        else:
            raise AttributeError(f"module {name!r} has no attribute {wanted!r}")
        if isinstance(value, ModuleType) and value.__name__ == f"{__package__}.{name}.{wanted}":
            value = stand_in(f"{name}.{wanted}")
        setattr(view, wanted, value)
        return value

    listed = sorted(item for item in names if not item.startswith("_"))
    vars(view).update(__all__=listed, __getattr__=attribute, __dir__=lambda: [*vars(view), *listed])
    return view


def imported(name: str) -> None:
    """Keep in mind that the present program has imported a module of ``rclpy``."""
    task = here()
    if task is not None and name.startswith("rclpy."):
        task.program.rclpy.setdefault("modules", set()).add(name.split(".")[1])


def _loaded() -> AbstractSet[str]:
    """Return the modules of ``rclpy`` that the present program's imports load."""
    task = here()
    own: set[str] = set() if task is None else task.program.rclpy.get("modules", set())
    return _ALWAYS | own | (frozenset() if _IMPORTING_NODES.isdisjoint(own) else _WITH_NODES)


def forget_members(names: Iterable[str]) -> None:
    """Undo that Python's import has made modules members of ``rclpy``, which all programs have in common."""
    for name in names:
        root, _, child = name.partition(".")
        if root == "rclpy" and child:
            vars(stand_in(root)).pop(child, None)


def _module_of_launch_files(name: str) -> ModuleType:
    """Return a module that launch files have: programs import it where a launch description is in their file."""
    from drake_twin.ros2 import stand_in_modules

    if stand_in_modules.exports(name) is None:
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)
    module = ModuleType(name)
    module.__path__ = []
    stand_in_modules.StandInLoader().exec_module(module)
    return module
