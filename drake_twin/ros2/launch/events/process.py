"""Events of processes, and matchers of the actions that start them (``launch.events.process``)."""

from collections.abc import Callable
from typing import Any

from drake_twin.ros2.launch.event import Event


class RunningProcessEvent(Event):
    """An event of one process.

    Attributes:
        action: The action that started it.
        process_name: Its name.
        cmd: Its command line.
    """

    def __init__(
        self,
        *,
        action: Any = None,
        name: str = "",
        cmd: list[str] | None = None,
        cwd: str | None = None,
        env: Any = None,
        pid: int = 0,
    ):
        self.action = action
        self.process_name = name
        self.cmd = list(cmd or [])
        self.cwd = cwd
        self.env = env
        self.pid = pid


class ProcessStarted(RunningProcessEvent):
    """A process has started."""

    name = "launch.events.process.ProcessStarted"


class ProcessExited(RunningProcessEvent):
    """A process has done its work: ``returncode`` is 0."""

    name = "launch.events.process.ProcessExited"

    def __init__(self, *, returncode: int = 0, **more: Any):
        super().__init__(**more)
        self.returncode = returncode


class ProcessIO(RunningProcessEvent):
    """A process has written or read text; never emitted, as the twin starts no process."""


class ProcessStdout(ProcessIO):
    """A process has written text to its standard output."""


class ProcessStderr(ProcessIO):
    """A process has written text to its standard error."""


class ProcessStdin(ProcessIO):
    """Text for a process's standard input."""


class ProcessTargetedEvent(Event):
    """An event for the processes that a matcher selects."""

    def __init__(self, *, process_matcher: Callable[[Any], bool]):
        self.process_matcher = process_matcher


class ShutdownProcess(ProcessTargetedEvent):
    """A process is asked to end."""


class SignalProcess(ProcessTargetedEvent):
    """A process gets a signal."""

    def __init__(self, *, signal_number: Any, process_matcher: Callable[[Any], bool]):
        super().__init__(process_matcher=process_matcher)
        self.signal = signal_number


def matches_pid(pid: int) -> Callable[[Any], bool]:
    """Return a matcher of a process id; it matches nothing, as the twin starts no process."""
    return lambda action: False


def matches_name(name: str) -> Callable[[Any], bool]:
    """Return a matcher of a process's name."""
    return lambda action: getattr(action, "name", None) == name


def matches_executable(executable: str) -> Callable[[Any], bool]:
    """Return a matcher of an executable."""
    return lambda action: bool(getattr(action, "cmd", None)) and action.cmd[0] == executable
