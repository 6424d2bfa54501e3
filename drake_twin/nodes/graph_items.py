"""What node programs have on the graph."""

from collections import deque
from collections.abc import Callable
from dataclasses import field
from typing import Any, Protocol

from drake_twin.dataclass import dataclass


@dataclass(eq=False)
class _Endpoint:
    """What publishers and subscriptions are told of each other.

    Attributes:
        listeners: Event of the quality of service → takes what changes in its status.
        matched: Those of nodes that it hears, or that hear it.
        is_timed: Whether there is a deadline, or a lease of liveliness.
        last: The time (ns) of the last message; None before the first.
        is_over: Whether it has been taken back.
    """

    listeners: dict[str, Callable[[dict[str, Any]], None]] = field(default_factory=dict, kw_only=True)
    matched: list[Any] = field(default_factory=list, kw_only=True)
    is_timed: bool = field(default=False, kw_only=True)
    last: int | None = field(default=None, kw_only=True)
    is_over: bool = field(default=False, kw_only=True)


@dataclass(eq=False)
class Publication(_Endpoint):
    """A topic that a node publishes.

    Attributes:
        topic: Its full name.
        type: Its ROS type.
        node: The full name of the node.
        depth: The number of messages that late subscribers get; zero for none.
        latched: These messages, each with the time (ns) at which it expires.
        is_best_effort: Whether messages may be lost.
        profile: Its quality of service, as the node gives it.
        command: The twin's topic that it commands; None without one.
        asserted: The time (ns) at which it has last said that it is alive; None before the first.
        is_lost: Whether it has not said so for its lease.
    """

    topic: str
    type: str
    node: str
    depth: int = 0
    latched: deque[Any] = field(default_factory=deque)
    is_best_effort: bool = False
    profile: Any = None
    command: Any = None
    asserted: int | None = None
    is_lost: bool = False

    def kept(self) -> list[Any]:
        """Return the messages that late subscribers get."""
        return [message for message, _ in list(self.latched)]


@dataclass(eq=False)
class Reception(_Endpoint):
    """A topic that a node subscribes to.

    Attributes:
        topic: Its full name.
        type: Its ROS type.
        node: The full name of the node.
        put: Takes a message, and the time (ns) at which it expires.
        wants_latched: Whether it gets what was published before.
        end: Ends the subscription to the twin's topic; None without one.
        is_best_effort: Whether messages may be lost.
        profile: Its quality of service, as the node gives it.
    """

    topic: str
    type: str
    node: str
    put: Callable[..., None]
    wants_latched: bool = False
    end: Callable[[], None] | None = None
    is_best_effort: bool = False
    profile: Any = None


@dataclass(eq=False)
class Caller:
    """A service that a node asks.

    Attributes:
        name: Its full name.
        type: Its ROS type.
        node: The full name of the node that asks.
    """

    name: str
    type: str
    node: str


@dataclass(eq=False)
class Offer:
    """A service that a node offers.

    Attributes:
        name: Its full name.
        type: Its ROS type.
        node: The full name of the node.
        put: Takes a request and the function that takes its response.
    """

    name: str
    type: str
    node: str
    put: Callable[[Any, Callable[[Any], None]], None]


class GoalListener(Protocol):
    """Who has sent a goal."""

    def answered(self, is_accepted: bool, stamp: Any = None) -> None:
        """Take note of whether the goal has been accepted, and when; without a time it is the present one."""

    def heard(self, feedback: Any) -> None:
        """Take note of feedback."""

    def moved(self, status: int) -> None:
        """Take note of the goal's status."""

    def ended(self, status: int, result: Any) -> None:
        """Take note of the end of a goal of the twin; without a result it is None."""
