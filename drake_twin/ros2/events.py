"""Events of a launch: what event handlers wait for."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext


class Event:
    """Something that happened."""

    name = "launch.Event"


class _ProcessEvent(Event):
    """An event of one process.

    Attributes:
        action: the action that started it.
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
        **more: Any,
    ):
        self.action = action
        self.process_name = name
        self.cmd = list(cmd or [])
        self.cwd = cwd
        self.env = env
        self.pid = pid


class ProcessStarted(_ProcessEvent):
    """A process has started."""

    name = "launch.events.process.ProcessStarted"


class ProcessExited(_ProcessEvent):
    """A process has done its work: ``returncode`` is 0."""

    name = "launch.events.process.ProcessExited"

    def __init__(self, *, returncode: int = 0, **more: Any):
        super().__init__(**more)
        self.returncode = returncode


class ExecutionComplete(Event):
    """An action has been executed."""

    name = "launch.events.ExecutionComplete"

    def __init__(self, *, action: Any):
        self.action = action


class IncludeLaunchDescription(Event):
    """A launch description is asked to be included."""

    name = "launch.events.IncludeLaunchDescription"

    def __init__(self, launch_description: Any):
        self.launch_description = launch_description


class Shutdown(Event):
    """The launch ends."""

    name = "launch.events.Shutdown"

    def __init__(self, *, reason: str = "reason not given", due_to_sigint: bool = False):
        self.reason = reason
        self.due_to_sigint = due_to_sigint


class TimerEvent(Event):
    """A timer is due."""

    name = "launch.events.TimerEvent"

    def __init__(self, *, timer_action: Any):
        self.timer_action = timer_action


class ProcessTargetedEvent(Event):
    """An event for the processes that a matcher names."""

    def __init__(self, *, process_matcher: Callable[[Any], bool]):
        self.process_matcher = process_matcher


class ShutdownProcess(ProcessTargetedEvent):
    """A process is asked to end."""


class SignalProcess(ProcessTargetedEvent):
    """A process gets a signal."""

    def __init__(self, *, signal_number: Any, process_matcher: Callable[[Any], bool]):
        super().__init__(process_matcher=process_matcher)
        self.signal = signal_number


class ProcessIO(_ProcessEvent):
    """A process has written or read text; never emitted, for nothing is run."""


class ProcessStdout(ProcessIO):
    """A process has written text to its standard output."""


class ProcessStderr(ProcessIO):
    """A process has written text to its standard error."""


class ProcessStdin(ProcessIO):
    """Text for a process's standard input."""


class ChangeState(Event):
    """A lifecycle node is asked to change its state."""

    name = "launch_ros.events.lifecycle.ChangeState"

    def __init__(self, *, lifecycle_node_matcher: Callable[[Any], bool], transition_id: int):
        self.lifecycle_node_matcher = lifecycle_node_matcher
        self.transition_id = transition_id


class StateTransition(Event):
    """A lifecycle node has changed its state."""

    name = "launch_ros.events.lifecycle.StateTransition"

    def __init__(self, *, action: Any, msg: Any = None, start_state: str = "", goal_state: str = ""):
        self.action = action
        self.msg = msg
        self.start_state = start_state
        self.goal_state = goal_state


def matches_action(target_action: Any) -> Callable[[Any], bool]:
    """A matcher of one action."""
    return lambda action: action is target_action


def matches_pid(pid: int) -> Callable[[Any], bool]:
    """A matcher of a process id; nothing here has one."""
    return lambda action: False


def matches_name(name: str) -> Callable[[Any], bool]:
    """A matcher of a process's name."""
    return lambda action: getattr(action, "name", None) == name


def matches_executable(executable: str) -> Callable[[Any], bool]:
    """A matcher of an executable."""
    return lambda action: bool(getattr(action, "cmd", None)) and action.cmd[0] == executable


def matches_node_name(node_name: str) -> Callable[[Any], bool]:
    """A matcher of a node's full name."""
    return lambda action: getattr(action, "node_name", None) == "/" + node_name.lstrip("/")


def handle_in(context: LaunchContext, event: Event) -> None:
    """What an event does by itself, before the handlers see it."""
    if isinstance(event, Shutdown):
        context.shut_down(event)
        return
    context.dispatch(event)
    if isinstance(event, IncludeLaunchDescription):
        from drake_twin.ros2.entity import visit_all

        visit_all(event.launch_description, context)
