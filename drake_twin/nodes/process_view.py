"""How the process looks to a node program while one of its threads runs."""

import os
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import FrameType, ModuleType
from typing import Any, Generic, TypeVar

from drake_twin.description.python_programs import PythonProgram
from drake_twin.nodes.stand_ins import ROOTS

_OF_ROS = {"ROS_VERSION": "2", "ROS_PYTHON_VERSION": "3", "ROS_DISTRO": "jazzy"}

Thread = TypeVar("Thread")


class ProcessView(ABC, Generic[Thread]):
    """The process as a node program sees it, and what the program keeps in it.

    While one of its threads has the baton, the process looks to it like its own: ``sys.argv``, ``sys.path``,
    ``os.environ``, and in ``sys.modules`` its own modules in place of others of these names.

    Args:
        index: Its place among the programs, which is the order of their turns.
        what: Its name in messages.
        found: The script.
        arguments: Its command line after the script.
        environment: Variables that differ from those of the process.

    Attributes:
        index: Its place among the programs.
        what: Its name in messages.
        file: The script.
        path: Its ``sys.path``.
        modules: Its own modules, which others do not see.
        lent: Modules that stand in for ROS's, which are given to it when it asks for them.
        own_folders: The folders on its path in which its own modules are.
        main: The thread that it begins with.
        threads: Its threads.
        rclpy: What the stand-in of rclpy keeps for it.
        jumped: Functions to call when time has jumped, with how far (ns).
        belongings: What it has on the graph.
        handlers: Its handlers of signals.
        at_exit: Functions that it calls at its end, with their arguments and options.
        folder: Its working folder; empty for that of the process.
        outer_folder: The working folder of the process.
    """

    main: Thread

    def __init__(
        self,
        index: int,
        what: str,
        found: PythonProgram,
        arguments: Sequence[str],
        environment: Mapping[str, str],
    ):
        self.index, self.what, self.file = index, what, found.file
        self.argv = [str(found.file), *arguments]
        own = [str(found.folder or found.file.parent)]  # a console script's own folder is another one
        self._base_path = frozenset(sys.path)
        self.path = [*dict.fromkeys((*own, *(folder for folder in sys.path if folder)))]
        self.environment = {**_OF_ROS, **os.environ, **environment}
        self.modules: dict[str, ModuleType] = {}
        self.lent: set[str] = set()
        self.own_names: set[str] = set()
        self.own_folders = own
        self.threads: list[Thread] = []
        self.rclpy: dict[str, Any] = {}
        self.jumped: list[Callable[[int], None]] = []
        self.belongings: list[Any] = []
        self.handlers: dict[int, Any] = {}
        self.at_exit: list[tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]] = []
        self.folder = self.outer_folder = ""
        self._outer: tuple[Any, ...] = ()
        self._hidden: dict[str, ModuleType] = {}
        names = {entry.stem for folder in own for entry in Path(folder).iterdir()} - sys.stdlib_module_names
        self._clashing = [name for name in sys.modules if name.partition(".")[0] in (names | ROOTS) - {"drake_twin"}]

    @abstractmethod
    def add(self, task: Thread) -> None:
        """Add a thread."""

    @abstractmethod
    def guard(self, run: Callable[[], object]) -> None:
        """Run one of its threads to its end, whatever it raises; the last non-daemon one ends the program."""

    @abstractmethod
    def exit(self, code: int) -> None:
        """End its other threads, and do nothing at its end."""

    @abstractmethod
    def handle_interrupt(self) -> bool:
        """Call its own handler of Ctrl-C; return whether it has one."""

    @abstractmethod
    def ignored(self, what: str) -> None:
        """Take note of something that it asks of ROS and the twin does not do, with the line that asks for it."""

    @abstractmethod
    def place(self, frame: FrameType | None) -> str:
        """Return the file and line of a program's own code that a frame runs; empty without one."""

    def extra_folders(self) -> list[str]:
        """Return the folders on the present ``sys.path`` that are only this program's."""
        return [folder for folder in sys.path if folder not in self._base_path or folder in self.own_folders]

    def enter(self) -> None:
        """Let the process look like the program's own."""
        modules = sys.modules
        self._outer = sys.argv, sys.path, os.environ
        sys.argv, sys.path = self.argv, self.path
        os.environ = self.environment  # type: ignore[assignment]  # noqa: B003  # the process's own stays
        for name in self._clashing:
            if name in modules:
                self._hidden[name] = modules.pop(name)
        for name, module in self.modules.items():
            if (hidden := modules.get(name)) is not None:
                self._hidden[name] = hidden
            modules[name] = module
        if self.folder:
            self.outer_folder = os.getcwd()
            os.chdir(self.folder)

    def leave(self) -> None:
        """Let the process look as it did before `enter`."""
        modules = sys.modules
        self.argv, self.path = sys.argv, sys.path
        self.environment = os.environ  # type: ignore[assignment]
        sys.argv, sys.path, os.environ = self._outer
        for name in self.own_names:
            module = modules.pop(name, None)
            if module is not None:
                self.modules[name] = module
        if self.lent:
            for name in self.lent:
                modules.pop(name, None)
            self.lent.clear()
        if self._hidden:
            modules.update(self._hidden)
            self._hidden.clear()
        if self.folder:
            os.chdir(self.outer_folder)

    def lend(self, name: str) -> None:
        """Let a module that is about to be imported be there until the baton is given back."""
        self.lent.add(name)

    def own_module(self, name: str) -> None:
        """Let a module that is about to be imported be the program's own, and hide another of its name."""
        if name not in self.own_names:
            self.own_names.add(name)
            hidden = sys.modules.pop(name, None)
            if hidden is not None:
                self._hidden[name] = hidden

    def set_module(self, name: str, module: ModuleType) -> None:
        """Give the program a module of its own; not while it has the baton."""
        self.own_names.add(name)
        self.modules[name] = module
