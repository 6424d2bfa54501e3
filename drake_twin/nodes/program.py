"""A node program: a script or a console script, with a view of the process of its own."""

import logging
import os
import signal
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import CodeType, FrameType, ModuleType
from typing import Any, Protocol

from drake_twin.description.python_programs import PythonProgram
from drake_twin.nodes.process_view import ProcessView
from drake_twin.nodes.task import Abandoned, Task, here
from drake_twin.nodes.turns import Turns

_log = logging.getLogger(__name__)
_OWN = str(Path(__file__).parent) + os.sep


class Teller(Protocol):
    """Is told how a program ends."""

    def failed(self, program: "Program", why: str) -> None:
        """Take note of a program that has failed."""

    def ignored(self, program: "Program", what: str) -> None:
        """Take note of something that a program asks of ROS and the twin does not do."""

    def ended(self, program: "Program") -> None:
        """Take note of a program that has ended."""


class Program(ProcessView[Task]):
    """A node program: its threads, and how it begins and ends.

    Args:
        index: Its place among the programs, which is the order of their turns.
        what: Its name in messages.
        found: The script.
        arguments: Its command line after the script.
        environment: Variables that differ from those of the process.
        turns: Hands out the baton.
        teller: Is told how it ends.
    """

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
        super().__init__(index, what, found, arguments, environment)
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
                self._teller.failed(self, f"it has ended with exit code {end.code}{self._at(end)}")
        except BaseException as error:
            _log.debug("node %s", self.what, exc_info=error)
            reason = " ".join(str(error).split())
            self._teller.failed(self, f"{type(error).__name__}: {reason}{self._at(error)}")
        if process != os.getpid():  # it has forked, and this is the child
            sys.stdout.flush()
            os._exit(0)
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

    def exit(self, code: int) -> None:
        """End its other threads, and do nothing at its end."""
        self.at_exit.clear()
        if code:
            place = self.place(sys._getframe())
            self._teller.failed(self, f"it has ended with exit code {code}" + (f" ({place})" if place else ""))
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
            handler(signal.SIGINT, sys._getframe())
            return True
        return bool(handler == signal.SIG_IGN)

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
            source = found.file.read_bytes()
            exec(compile(source, str(found.file), "exec"), main.__dict__)
            return
        # Not by an import, whose lock another program of this name would wait for if the module itself spins.
        parents = found.module.split(".")[:-1]
        for count in range(len(parents)):
            __import__(".".join(parents[: count + 1]))
        from importlib.util import module_from_spec, spec_from_file_location

        spec = spec_from_file_location(found.module, found.file)
        assert spec is not None
        assert spec.loader is not None
        module = module_from_spec(spec)
        self.own_module(found.module)
        sys.modules[found.module] = module
        self.modules[found.module] = module
        spec.loader.exec_module(module)
        function: Any = module
        for name in found.function.split("."):
            function = getattr(function, name)
        sys.exit(function())
