"""Event handlers: actions that wait for an event (``launch.event_handlers``)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from drake_twin.findings import Place
from drake_twin.ros2.entity import as_entities, place_of_caller, visit_list
from drake_twin.ros2.events import (
    Event,
    ExecutionComplete,
    IncludeLaunchDescription,
    ProcessExited,
    ProcessIO,
    ProcessStarted,
    Shutdown,
    StateTransition,
)

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext


class EventHandler:
    """Actions that wait for an event.

    Args:
        matcher: whether an event is the one.
        entities: what to visit then.
        handle_once: whether the handler ends with the first event.

    Attributes:
        captured: the configurations when it was registered. ROS uses those of firing time, so that in a loop over
            robots every handler sees the last one; a deliberate difference.
        fired: whether its event has come.
    """

    waits_for: type[Event] = Event

    def __init__(
        self, *, matcher: Callable[[Any], bool] | None = None, entities: Any = None, handle_once: bool = False
    ):
        self._matcher = matcher
        self._entities = entities
        self.handle_once = handle_once
        self.captured: Mapping[str, Any] = {}
        self.fired = False
        self.place: Place | None = place_of_caller()

    @property
    def entities(self) -> list[Any]:
        """What is visited when the event comes, where that is known before."""
        return [] if callable(self._entities) else as_entities(self._entities)

    @property
    def handler_description(self) -> str:
        """What it waits for, in words."""
        return self.what

    @property
    def what(self) -> str:
        """What it waits for, in words."""
        return type(self).__name__

    def matches(self, event: Any) -> bool:
        """Whether an event is the one."""
        return self._matcher is not None and bool(self._matcher(event))

    def run(self, event: Any, context: LaunchContext) -> None:
        """Visits the entities."""
        context.extend_locals({"event": event})
        with context.at(self.place):
            entities = self._entities
            if callable(entities) and not hasattr(entities, "visit"):
                entities = entities(event, context)
            visit_list(as_entities(entities), context)


class BaseEventHandler(EventHandler):
    """ROS's name for handlers that users derive from: they define ``handle``."""

    def handle(self, event: Any, context: LaunchContext) -> Any:
        """The entities to visit."""

    def run(self, event: Any, context: LaunchContext) -> None:
        """Visits what ``handle`` returns."""
        visit_list(as_entities(self.handle(event, context)), context)


class OnActionEventBase(EventHandler):
    """Waits for an event of one action, or of those that a function accepts, or of any."""

    def __init__(self, *, action_matcher: Any = None, on_event: Any = None, handle_once: bool = False, **more: Any):
        super().__init__(entities=on_event, handle_once=handle_once)
        self._target = action_matcher
        self.place = place_of_caller()

    def matches(self, event: Any) -> bool:
        """Whether the event is of the target."""
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


class OnProcessExit(OnActionEventBase):
    """Waits until a process has ended."""

    waits_for = ProcessExited

    def __init__(self, *, target_action: Any = None, on_exit: Any = None, handle_once: bool = False, **more: Any):
        super().__init__(action_matcher=target_action, on_event=on_exit, handle_once=handle_once)


class OnProcessStart(OnActionEventBase):
    """Waits until a process has started."""

    waits_for = ProcessStarted

    def __init__(self, *, target_action: Any = None, on_start: Any = None, handle_once: bool = False, **more: Any):
        super().__init__(action_matcher=target_action, on_event=on_start, handle_once=handle_once)


class OnProcessIO(OnActionEventBase):
    """Waits for text of a process. Nothing is run here, so it never comes."""

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
        super().__init__(action_matcher=target_action, on_event=on_stdout or on_stderr or on_stdin)


class OnExecutionComplete(OnActionEventBase):
    """Waits until an action has been executed."""

    waits_for = ExecutionComplete

    def __init__(self, *, target_action: Any = None, on_completion: Any = None, handle_once: bool = False, **more: Any):
        super().__init__(action_matcher=target_action, on_event=on_completion, handle_once=handle_once)


class OnShutdown(EventHandler):
    """Waits for the end of the launch."""

    waits_for = Shutdown

    def __init__(self, *, on_shutdown: Any = None, **more: Any):
        super().__init__(matcher=lambda event: isinstance(event, Shutdown), entities=on_shutdown)


class OnIncludeLaunchDescription(EventHandler):
    """Waits for a request to include a launch description."""

    waits_for = IncludeLaunchDescription

    def __init__(self, **more: Any):
        super().__init__(matcher=lambda event: isinstance(event, IncludeLaunchDescription), entities=None)


class OnStateTransition(OnActionEventBase):
    """Waits until a lifecycle node has changed its state.

    The twin does not run the node, so a transition is taken to have happened when it is asked for.
    """

    waits_for = StateTransition

    def __init__(
        self,
        *,
        target_lifecycle_node: Any = None,
        entities: Any = None,
        transition: str | None = None,
        start_state: str | None = None,
        goal_state: str | None = None,
        matcher: Callable[[Any], bool] | None = None,
        handle_once: bool = False,
        **more: Any,
    ):
        super().__init__(action_matcher=target_lifecycle_node, on_event=entities, handle_once=handle_once)
        self._goal_state = goal_state
        self._start_state = start_state
        self._matcher = matcher

    def matches(self, event: Any) -> bool:
        """Whether the event is of the target and its states are the ones."""
        if not super().matches(event):
            return False
        if self._matcher is not None and not self._matcher(event):
            return False
        return self._goal_state in (None, event.goal_state) and self._start_state in (None, event.start_state)


def event_named(name: str) -> Callable[[Any], bool]:
    """A matcher of events by their name."""
    return lambda event: getattr(event, "name", None) == name
