"""A node program: a script or a console script, with a view of the process of its own."""

import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import CodeType, FrameType, ModuleType, TracebackType
from typing import Any, Protocol

from drake_twin.description.python_programs import PythonProgram
from drake_twin.description.source_file import file_bytes
from drake_twin.nodes.child_processes import ChildProcesses
from drake_twin.nodes.missing_modules import remedy
from drake_twin.nodes.polls import compiled, prepare, with_waits
from drake_twin.nodes.ros2_command import with_command
from drake_twin.nodes.stand_ins import ROOTS, forget_members
from drake_twin.nodes.task import Abandoned, Task, here
from drake_twin.nodes.turns import Turns

_OF_ROS = {"ROS_VERSION": "2", "ROS_PYTHON_VERSION": "3", "ROS_DISTRO": "jazzy"}
_OWN = str(Path(__file__).parent) + os.sep
_process = threading.RLock()  # held while it looks like a program's: twins in other threads have programs, too


class Teller(Protocol):
    """Is told how a program ends."""

    def failed(self, program: "Program", why: str, error: BaseException | None = None) -> None:
        """Take note of a program that has failed, and of the error that has ended it."""

    def ignored(self, program: "Program", what: str) -> None:
        """Take note of something that a program asks of ROS and the twin does not do."""

    def ended(self, program: "Program") -> None:
        """Take note of a program that has ended."""


class Program:
    """A node program: its threads, how it begins and ends, and the process as it sees it.

    While one of its threads has the baton, the process looks to it like its own: ``sys.argv``, ``sys.path``,
    ``os.environ``, and in ``sys.modules`` its own modules in place of others of these names.

    Args:
        index: Its place among the programs, which is the order of their turns.
        what: Its name in messages.
        found: The script.
        arguments: Its command line after the script.
        environment: Variables that differ from those of the process.
        turns: Hands out the baton.
        teller: Is told how it ends.

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
        wakeup: The file descriptor that gets the numbers of signals; -1 without one.
        at_exit: Functions that it calls at its end, with their arguments and options.
        children: The processes that it has started.
        turns: How many turns it has had.
        memory: How much memory it has taken (bytes).
        exit_code: What it has ended with, as a process of its own would.
        folder: Its working folder; empty for that of the process.
        outer_folder: The working folder of the process.
    """

    main: Task

    def __init__(
        self,
        index: int,
        what: str,
        found: PythonProgram,
        arguments: Sequence[str],
        environment: Mapping[str, str],
        turns: Turns,
        teller: Teller,
    ):
        self.index, self.what, self.file = index, what, found.file
        self.argv = [str(found.file), *arguments]
        # A console script's own folder is another one.
        own = [str(folder) for folder in (*found.beside, found.folder or found.file.parent)]
        self._base_path = frozenset(sys.path)
        self.path = [*dict.fromkeys((*own, *(folder for folder in sys.path if folder)))]
        self.environment = with_command({**_OF_ROS, **os.environ, **environment})
        self.modules: dict[str, ModuleType] = {}
        self.lent: set[str] = set()
        self.own_names: set[str] = set()
        self.own_folders = own
        self.threads: list[Task] = []
        self.rclpy: dict[str, Any] = {}
        self.jumped: list[Callable[[int], None]] = []
        self.belongings: list[Any] = []
        self.handlers: dict[int, Any] = {}
        self.wakeup = -1
        self.at_exit: list[tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]] = []
        self.children = ChildProcesses()
        self.turns = self.memory = self.exit_code = 0
        self.folder = self.outer_folder = ""
        self._outer: tuple[Any, ...] = ()
        self._hidden: dict[str, ModuleType] = {}
        names = {entry.stem for folder in own for entry in Path(folder).iterdir()} - sys.stdlib_module_names
        self._clashing = [name for name in sys.modules if name.partition(".")[0] in (names | ROOTS) - {"drake_twin"}]
        self._is_over = False
        self._found, self._turns, self._teller = found, turns, teller

    def start(self) -> None:
        """Start the program; it runs when its turn comes."""
        self.main = Task(self._turns, self)
        self.add(self.main)
        self.main.start(lambda: self.guard(self._run))

    def add(self, task: Task) -> None:
        """Add a thread."""
        self.threads.append(task)
        self._turns.add(task)

    def guard(self, run: Callable[[], object]) -> None:
        """Run one of its threads to its end, whatever it raises; the last non-daemon one ends the program."""
        process = os.getpid()
        try:
            run()
        except (Abandoned, KeyboardInterrupt):
            pass
        except SystemExit as end:
            if end.code not in (None, 0):
                self.exit_code = end.code if isinstance(end.code, int) else 1
                self._teller.failed(self, f"it has ended with exit code {end.code}{self._at(end)}")
        except BaseException as error:
            self.exit_code = 1
            reason = " ".join(str(error).split())
            why = f"{type(error).__name__}: {reason}{remedy(error, self.file)}{self._at(error)}"
            self._teller.failed(self, why, error.with_traceback(self._own_traceback(error)))
        if process != os.getpid():  # it has forked, and this is the child
            sys.stdout.flush()
            os._exit(0)
        if (own := here()) is not None and own.is_outside and not self._turns.is_over:
            with suppress(Abandoned, KeyboardInterrupt):
                own.enter()  # what follows needs the baton
        is_last = all(task.is_daemon or task.has_ended or task is here() for task in self.threads)
        if is_last and not self._is_over:
            self._is_over = True
            while self.at_exit:
                function, arguments, options = self.at_exit.pop()
                self.guard(partial(function, *arguments, **options))
            for task in self.threads:
                if task.is_daemon:
                    task.end(Abandoned)
            self._teller.ended(self)
            if own is not None and own.is_outside:  # no `leave` follows
                self._forget_modules()

    def exit(self, code: int) -> None:
        """End its other threads, and do nothing at its end."""
        self.exit_code = code
        if code:
            place = self.place(sys._getframe())
            self._teller.failed(self, f"it has ended with exit code {code}" + (f" ({place})" if place else ""))
        self._end_others()

    def stop(self, why: str, place: str = "") -> None:
        """End a program that takes too much, as ``SIGKILL`` would.

        Args:
            why: What it takes.
            place: Where it does so; by default, the line that the present thread runs.
        """
        self.exit_code = -signal.SIGKILL
        place = place or self.place(sys._getframe())
        self._teller.failed(self, why + (f" ({place})" if place else ""))
        self._end_others()

    def _end_others(self) -> None:
        self.at_exit.clear()
        for task in self.threads:
            if task is not here():
                task.end(Abandoned)

    def ignored(self, what: str) -> None:
        """Take note of something that it asks of ROS and the twin does not do, with the line that asks for it."""
        place = self.place(sys._getframe())
        self._teller.ignored(self, what + (f" ({place})" if place else ""))

    def handle_interrupt(self) -> bool:
        """Call its own handler of Ctrl-C; return whether it has one."""
        handler = self.handlers.get(signal.SIGINT)
        if callable(handler) and handler is not signal.default_int_handler:
            self.handle(handler, signal.SIGINT, sys._getframe())
            return True
        return bool(handler == signal.SIG_IGN)

    def handle(self, handler: Callable[..., object], number: int, frame: FrameType | None) -> None:
        """Call its own handler of a signal, and write the number where it asks for that, as ``asyncio`` does."""
        handler(number, frame)
        if self.wakeup >= 0:
            with suppress(OSError):
                os.write(self.wakeup, bytes((number,)))

    def place(self, frame: FrameType | None) -> str:
        """Return the file and line of a program's own code that a frame runs; empty without one."""
        while frame is not None:
            if self._is_own(frame.f_code):
                return f"{frame.f_code.co_filename}:{frame.f_lineno}"
            frame = frame.f_back
        return ""

    def _at(self, error: BaseException) -> str:
        """Return where the program raised an error."""
        if isinstance(error, SyntaxError) and error.filename:
            return f" ({error.filename}:{error.lineno})"
        found = [
            f"{frame.f_code.co_filename}:{line}"
            for frame, line in traceback.walk_tb(error.__traceback__)
            if self._is_own(frame.f_code)
        ]
        return f" ({found[-1]})" if found else f" ({self.file})"

    def _own_traceback(self, error: BaseException) -> TracebackType | None:
        """Return what Python would print of an error: without the calls that lead to the program."""
        found = error.__traceback__
        while found is not None and not self._is_own(found.tb_frame.f_code):
            found = found.tb_next
        return found

    def _is_own(self, code: CodeType) -> bool:
        file = code.co_filename
        return file == str(self.file) or any(
            getattr(module, "__file__", None) == file and not file.startswith(_OWN) for module in self.modules.values()
        )

    def _run(self) -> None:
        found = self._found
        main = ModuleType("__main__")
        main.__dict__["__file__"] = str(found.file)
        main.__dict__["__builtins__"] = __builtins__
        self.own_module("__main__")
        sys.modules["__main__"] = main
        self.modules["__main__"] = main
        if not found.module:
            prepare(main)
            exec(compiled(file_bytes(found.file), str(found.file)), main.__dict__)
            return
        # Not by an import, whose lock another program of this name would wait for if the module itself spins.
        parents = found.module.split(".")[:-1]
        for count in range(len(parents)):
            __import__(".".join(parents[: count + 1]))
        from importlib.util import module_from_spec, spec_from_file_location

        spec = spec_from_file_location(found.module, found.file)
        assert spec is not None
        assert spec.loader is not None
        module = module_from_spec(with_waits(spec))
        self.own_module(found.module)
        sys.modules[found.module] = module
        self.modules[found.module] = module
        spec.loader.exec_module(module)
        function: Any = module
        for name in found.function.split("."):
            function = getattr(function, name)
        sys.exit(function())

    # How the process looks to it --------------------------------------------------------------------------------------

    def extra_folders(self) -> list[str]:
        """Return the folders on the present ``sys.path`` that are only this program's."""
        return [folder for folder in sys.path if folder not in self._base_path or folder in self.own_folders]

    def enter(self) -> None:
        """Let the process look like the program's own."""
        _process.acquire()
        modules = sys.modules
        self._outer = sys.argv, sys.path, os.environ
        sys.argv, sys.path = self.argv, self.path
        os.environ = self.environment  # type: ignore[assignment]  # noqa: B003  # the process's own stays
        for name in self._clashing:
            if name in modules:
                self._hidden[name] = modules.pop(name)
        for name, module in tuple(self.modules.items()):  # a thread of it that is outside may import one
            if (hidden := modules.get(name)) is not None:
                self._hidden[name] = hidden
            modules[name] = module
        if self.folder:
            with suppress(OSError):  # it was removed
                self.outer_folder = os.getcwd()
                os.chdir(self.folder)

    def leave(self) -> None:
        """Let the process look as it did before `enter`."""
        modules = sys.modules
        self.argv, self.path = sys.argv, sys.path
        self.environment = os.environ  # type: ignore[assignment]
        sys.argv, sys.path, os.environ = self._outer
        for name in tuple(self.own_names):
            module = modules.pop(name, None)
            if module is not None:
                self.modules[name] = module
        if self.lent:
            for name in self.lent:
                modules.pop(name, None)
            forget_members(self.lent)
            self.lent.clear()
        if self._hidden:
            modules.update(self._hidden)
            self._hidden.clear()
        if self.folder:
            with suppress(OSError):
                os.chdir(self.outer_folder)
        if self._is_over:
            self._forget_modules()
        _process.release()

    def _forget_modules(self) -> None:
        """Let go of its modules, and of what they keep in memory; a thread that ends later has the process's."""
        self.modules.clear()
        self.own_names.clear()

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
