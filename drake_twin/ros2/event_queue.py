"""The events of a launch in simulation time, and the handlers that wait for them."""

import heapq
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.ros2.launch.event import Event

# A launch file whose events call each other for ever ends here.
_MOST_EVENTS = 20_000


class Handler(Protocol):
    """An event handler, such as `drake_twin.ros2.launch.event_handler.EventHandler`.

    Attributes:
        waits_for: The kind of its events.
        handle_once: Whether the handler ends with its first event.
        fired: Whether one of its events has come.
        captured: What `LaunchContext.snapshot` returned when it was registered.
        place: Where it was written.
    """

    waits_for: type[Event]
    handle_once: bool
    fired: bool
    captured: Mapping[str, Any]
    place: Place | None

    @property
    def what(self) -> str:
        """What it waits for, in words."""

    @property
    def entities(self) -> list[Any]:
        """What is visited when the event comes, where that is known before."""

    def matches(self, event: Any) -> bool:
        """Return whether the handler waits for an event."""

    def run(self, event: Any, context: Any) -> None:
        """Visit what the handler's function returns, or its entities."""


class EventQueue:
    """Calls what is due, by simulation time and then in the order in which it came.

    Args:
        run_handler: Runs a handler for an event.

    Attributes:
        time: Simulation time (s) of the actions that are being executed.
        handlers: The registered handlers, in the order in which they are asked.
        is_shutdown: Whether the launch has ended.
        shutdown_reason: Why, where it has.
        shutdown_time: When (s), where it has.
    """

    def __init__(self, run_handler: Callable[[Handler, Any], None]):
        self.time = 0.0
        self.handlers: list[Handler] = []
        self.is_shutdown = False
        self.shutdown_reason: str | None = None
        self.shutdown_time: float | None = None
        self._run_handler = run_handler
        self._queue: list[tuple[float, int, Callable[[], None]]] = []
        self._sequence = 0

    def after(self, delay: float, call: Callable[[], None]) -> None:
        """Call something ``delay`` (simulated s) from now, after everything that is due before it."""
        self._sequence += 1
        heapq.heappush(self._queue, (self.time + max(0.0, delay), self._sequence, call))

    def dispatch(self, event: Any) -> None:
        """Run the handlers that wait for an event."""
        for handler in list(self.handlers):
            if handler in self.handlers and handler.matches(event):
                handler.fired = True
                if handler.handle_once:
                    self.handlers.remove(handler)
                self._run_handler(handler, event)

    def run(self) -> None:
        """Call everything that is due, until nothing is left or the launch has ended.

        Raises:
            InputError: If the events do not come to an end.
        """
        count = 0
        while self._queue:
            time, _, call = heapq.heappop(self._queue)
            count += 1
            if count > _MOST_EVENTS:
                raise InputError(f"after {_MOST_EVENTS} events the launch still has not come to rest: does it loop?")
            self.time = time
            if not self.is_shutdown:
                call()

    def come_to_rest(self, handlers: list[Handler], time: float) -> None:
        """Be as before something was evaluated that may follow later."""
        self.handlers, self.time = handlers, time
        self.is_shutdown, self.shutdown_reason, self.shutdown_time = False, None, None
        self._queue.clear()

    def shut_down(self, event: Any) -> None:
        """End the launch: the OnShutdown handlers run, and nothing starts any more."""
        if not self.is_shutdown:
            self.shutdown_reason, self.shutdown_time = event.reason, self.time
            self.dispatch(event)
            self.is_shutdown = True
