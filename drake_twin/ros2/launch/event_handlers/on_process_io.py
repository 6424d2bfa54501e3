"""Waits for text of a process, which never comes: the twin starts no process."""

from typing import Any

from drake_twin.ros2.launch.event_handlers.on_action_event_base import OnActionEventBase
from drake_twin.ros2.launch.events.process import ProcessIO


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
