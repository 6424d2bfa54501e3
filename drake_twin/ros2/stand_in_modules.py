"""The tree of stand-ins: a module of ROS is the file of the same path below this folder.

``launch.actions.timer_action`` is ``launch/actions/timer_action.py``. While launch files run, `StandInFinder` gives
them these modules under ROS's own names.
"""

import importlib
import importlib.abc
import importlib.machinery
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

from drake_twin.extensions import import_own
from drake_twin.ros2.lazy_exports import EXPORTS

_TREE = __package__
_FOLDER = Path(__file__).parent

ROOTS = frozenset(file.parent.name for file in _FOLDER.glob("*/__init__.py"))


@lru_cache(maxsize=256)
def exports(module: str) -> Mapping[str, str] | None:
    """Return the public names of a module of ROS, each with the module of the tree that holds it.

    A module inside a package has its package's names, too, as ROS's modules import from each other. Where the tree
    gathers several classes of ROS in one file, the file of each (``launch.actions.log_warning``) has its package's.

    Returns:
        None if ROS has no such module, as far as the twin knows.
    """
    package, _, last = module.rpartition(".")
    path = _FOLDER.joinpath(*module.split("."))
    if (path / "__init__.py").is_file():
        return _public(f"{_TREE}.{module}")
    own = _public(f"{_TREE}.{module}") if path.with_suffix(".py").is_file() else {}
    known = (exports(package) if package else None) or {}
    if own:
        return {**known, **own} if "." in package else own
    is_class = last.replace("_", "").lower() in {name.lower() for name in known}
    return known if is_class or last in known else None


def _public(module: str) -> dict[str, str]:
    """Return a module's lazy exports, its ``__all__``, or else the classes and functions that are defined in it."""
    found = import_own(module)
    if module in EXPORTS:
        return EXPORTS[module]
    names = getattr(found, "__all__", None)
    if names is None:
        names = [name for name, value in vars(found).items() if getattr(value, "__module__", None) == module]
    return {name: module for name in names if not name.startswith("_")}


def stand_in(module: str, name: str) -> Any:
    """Return what stands for a name of a module of ROS.

    Raises:
        AttributeError: If the twin knows no such name.
    """
    names = exports(module) or {}
    if name not in names:
        raise AttributeError(f"module {module!r} has no attribute {name!r}")
    return getattr(import_own(names[name]), name)


class StandInFinder(importlib.abc.MetaPathFinder):
    """Finds the stand-in modules."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Return a stand-in's spec; None for modules that are not ROS's."""
        if fullname.partition(".")[0] not in ROOTS:
            return None
        if exports(fullname) is None:
            raise ModuleNotFoundError(f"No module named {fullname!r}", name=fullname)
        return importlib.machinery.ModuleSpec(fullname, StandInLoader(), is_package=True)


class StandInLoader(importlib.abc.Loader):
    """Loads a stand-in module, whose names are taken from the tree when they are first asked for."""

    def exec_module(self, module: ModuleType) -> None:
        """Give the module its names and its submodules."""

        def attribute(name: str) -> Any:
            full = f"{module.__name__}.{name}"
            if name in module.__all__ or name.startswith("__") or exports(full) is None:
                value = stand_in(module.__name__, name)
                setattr(module, name, value)
                return value
            return importlib.import_module(full)

        module.__all__ = sorted(exports(module.__name__) or ())  # type: ignore[attr-defined]
        module.__getattr__ = attribute  # type: ignore[method-assign]
