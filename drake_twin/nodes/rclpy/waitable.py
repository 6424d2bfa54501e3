"""Stand-in for ``rclpy.waitable``: things of a user's own that an executor waits for."""

import inspect
from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar

from drake_twin.nodes.rclpy.handle import Handle

WaitableEntityType = TypeVar("WaitableEntityType")


class NumberOfEntities:
    """How many things of each kind a waitable has."""

    __slots__ = (  # noqa: RUF023  # in the order of its arguments
        "num_subscriptions",
        "num_guard_conditions",
        "num_timers",
        "num_clients",
        "num_services",
        "num_events",
    )

    def __init__(
        self,
        num_subs: int = 0,
        num_gcs: int = 0,
        num_timers: int = 0,
        num_clients: int = 0,
        num_services: int = 0,
        num_events: int = 0,
    ):
        numbers = num_subs, num_gcs, num_timers, num_clients, num_services, num_events
        for name, number in zip(self.__slots__, numbers, strict=True):
            setattr(self, name, number)

    def __add__(self, other: "NumberOfEntities") -> "NumberOfEntities":
        return NumberOfEntities(*(getattr(self, name) + getattr(other, name) for name in self.__slots__))

    def __repr__(self) -> str:
        return f"<NumberOfEntities({', '.join(str(getattr(self, name)) for name in self.__slots__)})>"


class WaitedHandle(Handle):
    """A handle of something that a waitable can wait for.

    Args:
        end: Ends it.
        is_ready: Returns whether it has something to do.
        take: Is called when a waitable has been told so; it is no longer ready then.
    """

    def __init__(self, end: Callable[[], Any], is_ready: Callable[[], bool], take: Callable[[], Any] = lambda: None):
        super().__init__(end)
        self._is_ready, self.take = is_ready, take


class WaitSet:
    """What a waitable waits for: handles of what a node has, each with a number among those of its kind."""

    def __init__(self) -> None:
        self._handles: dict[str, list[Any]] = {}

    def _add(self, kind: str, handle: Any) -> int:
        handles = self._handles.setdefault(kind, [])
        handles.append(handle)
        return len(handles) - 1

    def add_subscription(self, handle: Any) -> int:
        return self._add("subscription", handle)

    def add_guard_condition(self, handle: Any) -> int:
        return self._add("guard_condition", handle)

    def add_timer(self, handle: Any) -> int:
        return self._add("timer", handle)

    def add_client(self, handle: Any) -> int:
        return self._add("client", handle)

    def add_service(self, handle: Any) -> int:
        return self._add("service", handle)

    def is_ready(self, kind: str, index: int) -> bool:
        handles = self._handles.get(kind, [])
        if index >= len(handles):
            raise IndexError("wait set index too big")
        return bool(handles[index]._is_ready())

    def take(self) -> None:
        """Let what is ready, and says so but once, be ready no longer."""
        for handle in self._handles.get("guard_condition", ()):
            if handle._is_ready():
                handle.take()


class Waitable:
    """Something of a user's own that an executor waits for, and does in a callback group."""

    def __init__(self, callback_group: Any):
        self.callback_group = callback_group
        callback_group.add_entity(self)
        self._futures: list[Any] = []

    def __enter__(self) -> None:
        pass

    def __exit__(self, t: Any, v: Any, tb: Any) -> None:
        pass

    def add_future(self, future: Any) -> None:
        self._futures.append(future)

    def remove_future(self, future: Any) -> None:
        self._futures.remove(future)

    def is_ready(self, wait_set: Any) -> bool:
        raise NotImplementedError("Must be implemented by subclass")

    def take_data(self) -> Any:
        raise NotImplementedError("Must be implemented by subclass")

    async def execute(self, taken_data: Any) -> None:
        raise NotImplementedError("Must be implemented by subclass")

    def get_num_entities(self) -> NumberOfEntities:
        raise NotImplementedError("Must be implemented by subclass")

    def add_to_wait_set(self, wait_set: Any) -> None:
        raise NotImplementedError("Must be implemented by subclass")


class GraphWaitable(Waitable):
    """A waitable of rclpy's own, for which the graph puts events.

    Args:
        callback_group: Its group.
    """

    def __init__(self, callback_group: Any):
        super().__init__(callback_group)
        self._events: deque[Callable[[], Any]] = deque()

    def _post(self, event: Callable[[], Any]) -> None:
        """Let something happen at the next spin."""
        self._events.append(event)

    def is_ready(self, wait_set: Any) -> bool:
        return bool(self._events)

    def take_data(self) -> Any:
        return self._events.popleft()

    async def execute(self, taken_data: Any) -> None:
        found = taken_data()
        if inspect.isawaitable(found):
            await found

    def get_num_entities(self) -> NumberOfEntities:
        return NumberOfEntities()

    def add_to_wait_set(self, wait_set: Any) -> None:
        """Do nothing: the graph puts its events."""


class Waiting:
    """A waitable among what a node has, which an executor asks without a wait set.

    Args:
        waitable: The waitable.
    """

    def __init__(self, waitable: Waitable):
        self.waitable = waitable
        self.callback_group = waitable.callback_group
        self._wait_set = WaitSet()

    def _is_ready(self) -> bool:
        self._wait_set = WaitSet()
        self.waitable.add_to_wait_set(self._wait_set)
        return bool(self.waitable.is_ready(self._wait_set))

    def _execute(self) -> Any:
        self._wait_set.take()
        return self.waitable.execute(self.waitable.take_data())
