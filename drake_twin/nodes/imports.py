"""The imports of node programs: ROS's Python packages are stand-ins, and each program has modules of its own.

Other threads of the process see none of it, so that a ROS that is installed is not shadowed.
"""

import importlib
import importlib.abc
import importlib.machinery
import importlib.util
import sys
from collections.abc import Callable, Iterable, Sequence
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType

from drake_twin.description.python_modules import module_spec, python_modules
from drake_twin.nodes.polls import with_waits
from drake_twin.nodes.program import Program
from drake_twin.nodes.stand_ins import YIELDING, imported
from drake_twin.nodes.task import here
from drake_twin.nodes.windows import opencv_spec, prepare_qt, replace_windows

Source = Callable[[str], ModuleType | None]  # a module's full name → the module


class NodeFinder(importlib.abc.MetaPathFinder):
    """Finds the modules of node programs, for their threads only.

    Args:
        sources: Return the modules that stand in for ROS's.
        folder_of: Returns the folder of a ROS package; None without one.
        packages: Returns the folders of all packages of the workspace.
    """

    def __init__(
        self,
        sources: Sequence[Source],
        folder_of: Callable[[str], Path | None],
        packages: Callable[[], Iterable[Path]] = tuple,
    ):
        self._sources = sources
        self._folder_of = folder_of
        self._packages = packages
        self._is_busy = False
        if "cv2" in sys.modules:
            replace_windows(sys.modules["cv2"])

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return a module's spec; None outside of node programs, and for modules that all share."""
        task = here()
        root, dot, _ = fullname.partition(".")
        if task is None or self._is_busy or root == "drake_twin" or root in sys.stdlib_module_names:
            return None
        self._is_busy = True  # what is imported to find a module is not the program's
        try:
            return self._find(task.program, fullname, root, dot, path)
        finally:
            self._is_busy = False

    def _find(
        self, program: Program, fullname: str, root: str, dot: str, path: Sequence[str] | None
    ) -> ModuleSpec | None:
        if (spec := opencv_spec(fullname)) is not None:
            return spec
        prepare_qt(fullname, program)
        own = root in YIELDING and (folder := self._folder_of(root)) is not None and root in python_modules(folder)
        for source in () if own else self._sources:
            if (module := source(fullname)) is not None:
                imported(fullname)
                program.lent.add(fullname)  # until the baton is given back
                return ModuleSpec(fullname, _Given(module), is_package=hasattr(module, "__path__"))
        if not dot:
            spec = PathFinder.find_spec(fullname, program.extra_folders()) or self._in_workspace(fullname)
        elif root in program.own_names:
            spec = PathFinder.find_spec(fullname, None if path is None else list(path))
        if spec is not None:
            program.own_module(fullname)
            return with_waits(spec)
        return None

    def _in_workspace(self, name: str) -> ModuleSpec | None:
        """Return the Python module that a ROS package installs: the one of this name, or else any."""
        folder = self._folder_of(name)
        if folder is not None and (spec := module_spec(name, [folder])) is not None:
            return spec
        return None if PathFinder.find_spec(name) is not None else module_spec(name, self._packages())


class _Given(importlib.abc.Loader):
    """Loads a module that exists already."""

    def __init__(self, module: ModuleType):
        self._module = module
        self._spec = module.__spec__

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return self._module

    def exec_module(self, module: ModuleType) -> None:
        module.__spec__ = self._spec
