"""The processes that a node program starts: so many at a time, and it is ended."""

import contextlib
import mmap
import os
import signal
import subprocess
from collections.abc import Callable
from typing import Any

from drake_twin.nodes.ros2_command import missing
from drake_twin.nodes.task import Abandoned, Task

MOST_PROCESSES = 100
_ENVIRONMENT = 10  # its place among the arguments of ``subprocess.Popen`` after the first
_MARKS = 4096  # of descendants, by the remainder of their numbers


class ChildProcesses:
    """The processes that a program has started and that still run."""

    def __init__(self) -> None:
        self._running: list[int] = []
        self._marks: mmap.mmap | None = None

    def has_room(self) -> bool:
        """Return whether another process may be started."""
        if len(self._running) >= MOST_PROCESSES:
            self._running = [number for number in self._running if _runs(number)]
        return len(self._running) < MOST_PROCESSES

    def add(self, number: int) -> None:
        """Add a process that was started."""
        self._running.append(number)

    def kill(self) -> None:
        """End them at once."""
        for number in self._running:
            if _runs(number):
                with contextlib.suppress(OSError):
                    os.kill(number, signal.SIGKILL)

    def share_marks(self) -> None:
        """Let forked processes mark themselves where all of them can see it."""
        if self._marks is None:
            self._marks = mmap.mmap(-1, _MARKS)

    def limit_forks(self) -> None:
        """Let the present process, which is a fork of the program, and its own forks be so many at most."""
        marks, fork = self._marks, os.fork
        if marks is None:
            return

        def limited() -> int:
            if _MARKS - marks[:].count(0) >= MOST_PROCESSES:
                os._exit(1)  # what an error said would be said by each of them
            if not (number := fork()):
                marks[os.getpid() % _MARKS] = 1
            return number

        os.fork = limited


def fork(task: Task, real: Callable[[], int]) -> int:
    """Fork, as ``os.fork`` of a program."""
    children = _with_room(task)
    children.share_marks()
    number = real()
    if number:
        children.add(number)
    return number


def spawn(task: Task, real: Callable[..., int], *arguments: Any, **options: Any) -> int:
    """Start a process, as ``os.posix_spawn`` of a program."""
    children = _with_room(task)
    number = real(*arguments, **options)
    children.add(number)
    return number


def open_process(task: Task, real: Callable[..., None], process: Any, *arguments: Any, **options: Any) -> None:
    """Start a process, as ``subprocess.Popen`` of a program."""
    children = _with_room(task)
    if len(arguments) <= _ENVIRONMENT and options.get("env") is None:
        options["env"] = dict(task.program.environment)  # the process's own does not have what the program has set
    environment = options.get("env") or arguments[_ENVIRONMENT] or {}
    call = arguments[0] if arguments else options.get("args")
    has_wires = task.program.rclpy["graph"].outside.source is not None
    for text in missing(call, environment, has_wires=has_wires):
        task.program.ignored(text)
    real(process, *arguments, **options)
    children.add(process.pid)


def call_shell(task: Task, real: Callable[[Any], int], command: Any) -> int:
    """Run a command in a shell, as ``os.system`` of a program."""
    code = subprocess.Popen(command, shell=True).wait()
    return code << 8 if code >= 0 else -code


# (place, name, what node programs have there), see `drake_twin.nodes.process_calls.seen_by_nodes`
REPLACEMENTS: tuple[tuple[Any, str, Callable[..., Any]], ...] = (
    (os, "fork", fork),
    (os, "posix_spawn", spawn),
    (os, "posix_spawnp", spawn),
    (os, "system", call_shell),
    (subprocess.Popen, "__init__", open_process),
)


def _with_room(task: Task) -> ChildProcesses:
    children: ChildProcesses = task.program.children
    if not children.has_room():
        task.program.stop(f"it has started {MOST_PROCESSES} processes that still run, and is ended with them")
        children.kill()
        raise Abandoned
    return children


def _runs(number: int) -> bool:
    """Return whether a process of the present one has not ended."""
    try:
        return os.waitid(os.P_PID, number, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None
    except OSError:  # its end is known already
        return False
