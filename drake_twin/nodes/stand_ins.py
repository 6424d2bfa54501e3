"""The modules of this package's tree that stand in for ROS's Python packages."""

import importlib
from functools import cache
from pathlib import Path
from types import ModuleType

_FOLDER = Path(__file__).parent
_OF_LAUNCH_FILES = frozenset(("tf_transformations",))  # packages of `drake_twin.ros2` that node programs have, too
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
    path = _FOLDER.joinpath(*name.split("."))
    if not path.with_suffix(".py").is_file() and not (path / "__init__.py").is_file():
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)
    return importlib.import_module(f"{__package__}.{name}")


def _module_of_launch_files(name: str) -> ModuleType:
    """Return a module that launch files have: programs import it where a launch description is in their file."""
    from drake_twin.ros2.stand_in_modules import StandInLoader, exports

    if exports(name) is None:
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)
    module = ModuleType(name)
    module.__path__ = []
    StandInLoader().exec_module(module)
    return module
