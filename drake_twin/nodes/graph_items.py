"""What node programs have on the graph."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol


@dataclass(eq=False)
class Publication:
    """A topic that a node publishes.

    Attributes:
        topic: Its full name.
        type: Its ROS type.
        node: The full name of the node.
        depth: The number of messages that late subscribers get; zero for none.
        latched: These messages.
        is_best_effort: Whether messages may be lost.
        profile: Its quality of service, as the node gives it; None where it gives none.
    """

    topic: str
    type: str
    node: str
    depth: int = 0
    latched: deque[Any] = field(default_factory=deque)
    is_best_effort: bool = False
    profile: Any = None


@dataclass(eq=False)
class Reception:
    """A topic that a node subscribes to.

    Attributes:
        topic: Its full name.
        type: Its ROS type.
        node: The full name of the node.
        put: Takes a message.
        wants_latched: Whether it gets what was published before.
        end: Ends the subscription to the twin's topic; None without one.
        is_best_effort: Whether messages may be lost.
        profile: Its quality of service, as the node gives it; None where it gives none.
    """

    topic: str
    type: str
    node: str
    put: Callable[[Any], None]
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

    def answered(self, is_accepted: bool) -> None:
        """Take note of whether the goal has been accepted."""

    def heard(self, feedback: Any) -> None:
        """Take note of feedback."""

    def ended(self, status: int, result: Any) -> None:
        """Take note of the goal's end; without a result it is None."""
