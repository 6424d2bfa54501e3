"""Handlers of the events of actions."""

from typing import Any

from drake_twin.ros2.launch.event_handler import EventHandler
from drake_twin.ros2.launch.events.execution_complete import ExecutionComplete
from drake_twin.ros2.launch.events.process import ProcessExited, ProcessIO, ProcessStarted


class OnActionEventBase(EventHandler):
    """Waits for an event of one action, or of those that a function accepts, or of any."""

    def __init__(self, *, action_matcher: Any = None, on_event: Any = None, **more: Any):
        super().__init__(entities=on_event, **more)
        self._target = action_matcher

    def matches(self, event: Any) -> bool:
        """Return whether the event is of the target."""
        if not isinstance(event, self.waits_for):
            return False
        action = getattr(event, "action", None)
        if self._target is None:
            return True
        if callable(self._target) and not hasattr(self._target, "visit"):
            return bool(self._target(action))
        return action is self._target

    @property
    def what(self) -> str:
        """What it waits for, in words."""
        target = self._target
        described = "any process" if target is None else getattr(target, "what", None) or getattr(target, "place", "")
        return f"{type(self).__name__} of {described}"


class OnExecutionComplete(OnActionEventBase):
    """Waits until an action has been executed."""

    waits_for = ExecutionComplete

    def __init__(self, *, target_action: Any = None, on_completion: Any = None, **more: Any):
        super().__init__(action_matcher=target_action, on_event=on_completion, **more)


class OnProcessStart(OnActionEventBase):
    """Waits until a process has started."""

    waits_for = ProcessStarted

    def __init__(self, *, target_action: Any = None, on_start: Any = None, **more: Any):
        super().__init__(action_matcher=target_action, on_event=on_start, **more)


class OnProcessExit(OnActionEventBase):
    """Waits until a process has ended."""

    waits_for = ProcessExited

    def __init__(self, *, target_action: Any = None, on_exit: Any = None, **more: Any):
        super().__init__(action_matcher=target_action, on_event=on_exit, **more)


class OnProcessIO(OnActionEventBase):
    """Waits for text of a process, which never comes: the twin starts no process."""

    waits_for = ProcessIO

    def __init__(
        self,
        *,
        target_action: Any = None,
        on_stdin: Any = None,
        on_stdout: Any = None,
        on_stderr: Any = None,
        **more: Any,
    ):
        super().__init__(action_matcher=target_action, on_event=on_stdout or on_stderr or on_stdin, **more)
