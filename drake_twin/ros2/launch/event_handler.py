"""Event handlers: actions that wait for an event."""

from collections.abc import Callable, Mapping
from typing import Any

from drake_twin.findings import Place
from drake_twin.ros2.launch.event import Event
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.utilities.normalize_to_list_of_entities_impl import normalize_to_list_of_entities
from drake_twin.ros2.places import place_of_caller
from drake_twin.ros2.visiting import visit_list

__all__ = ["BaseEventHandler", "EventHandler"]


class EventHandler:
    """Actions that wait for an event.

    Args:
        matcher: Whether an event is the one.
        entities: What to visit then, or a function of the event and the context that returns it.
        handle_once: Whether the handler ends with its first event.

    Attributes:
        captured: The configurations when it was registered. ROS uses those of the time when it fires, so that in a
            loop over robots every handler sees the last one; a deliberate difference.
        fired: Whether its event has come.
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
        return [] if callable(self._entities) else normalize_to_list_of_entities(self._entities)

    @property
    def handler_description(self) -> str:
        """What it waits for, in words."""
        return self.what

    @property
    def what(self) -> str:
        """What it waits for, in words."""
        return type(self).__name__

    def matches(self, event: Any) -> bool:
        """Return whether an event is the one."""
        return self._matcher is not None and bool(self._matcher(event))

    def handle(self, event: Any, context: LaunchContext) -> Any:
        """Return the entities to visit."""
        entities = self._entities
        if callable(entities) and not hasattr(entities, "visit"):
            return entities(event, context)
        return entities

    def run(self, event: Any, context: LaunchContext) -> None:
        """Visit what `handle` returns."""
        context.extend_locals({"event": event})
        with context.at(self.place):
            visit_list(normalize_to_list_of_entities(self.handle(event, context)), context)


BaseEventHandler = EventHandler
