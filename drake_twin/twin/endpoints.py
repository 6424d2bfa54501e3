"""What a twin offers to the world outside: topics out and in, actions and services."""

from collections.abc import Callable, Iterator
from typing import Any, Protocol

from drake_twin.dataclass import dataclass
from drake_twin.diagram.topics import CommandTopic, PublishedTopic
from drake_twin.diagram.twin_diagram import TwinDiagram

TWIN_NODE = "/drake_twin"
PUBLISHED, COMMANDED, ACTION = "published", "commanded", "action"


@dataclass(frozen=True)
class Endpoint:
    """A topic or an action.

    Attributes:
        kind: ``published``, ``commanded`` (a topic that controllers listen to) or ``action``.
        name: Its name.
        type: Its ROS type.
        node: The full name of the node that has it in ROS.
        rate: The rate at which ROS would publish it (Hz); None without one.
        latched: Whether it is published once, and late joiners get it, too.
        robot: The robot that it belongs to; empty for the twin's own.
        controller: The controller that it belongs to; empty without one.
        is_best_effort: Whether messages may be lost.
        depth: How many messages are kept for who is slow or late; 0 for what suits the topic.
        lifespan: How long messages are kept (s); None for always.
        keeps_all: Whether all messages are kept, whatever the depth.
        deadline: The longest time between messages that is offered, or requested (s); None for any.
        is_manual: Whether the publisher says itself that it is alive.
        lease: The time in which it has to (s); None for any.
        of_all_nodes: Whether each node publishes it.
    """

    kind: str
    name: str
    type: str
    node: str
    rate: float | None = None
    latched: bool = False
    robot: str = ""
    controller: str = ""
    is_best_effort: bool = False
    depth: int = 0
    lifespan: float | None = None
    keeps_all: bool = False
    deadline: float | None = None
    is_manual: bool = False
    lease: float | None = None
    of_all_nodes: bool = False


class ServiceEndpoint(Protocol):
    """A service of the twin, as `drake_twin.services.Service` has it."""

    @property
    def name(self) -> str:
        """Its full name."""

    @property
    def type(self) -> str:
        """Its ROS type."""

    @property
    def node(self) -> str:
        """The full name of its node."""

    @property
    def between_advances(self) -> bool:
        """Whether it does what a callback cannot do."""

    @property
    def answer(self) -> Callable[[Any], Any]:
        """Takes the request; returns the response's fields, or a generator that returns them later."""


class MoreTopics(Protocol):
    """What node programs have between themselves.

    Attributes:
        publications: Topic → what is published on it: its topic, type and latched messages.
        taps: Are called with such a publication and each message.
    """

    publications: dict[str, Any]
    taps: list[Callable[[Any, Any], None]]

    def endpoints(self) -> Iterator[Endpoint]:
        """Yield the topics that the twin itself does not have."""

    def hear(self, topic: str, message: Any) -> None:
        """Take a message from outside."""


def endpoints_of(built: TwinDiagram) -> tuple[Endpoint, ...]:
    """Return the endpoints of a diagram; a topic of several robots is one, of the first of them."""
    namespaces = {plan.name: plan.robot.topic_namespace for plan in built.plans}
    found: dict[tuple[str, str], Endpoint] = {}

    def add(kind: str, item: PublishedTopic | CommandTopic, **more: float | bool | None) -> None:
        node = _node(item, namespaces.get(item.robot, ""))
        endpoint = Endpoint(kind, item.topic, item.type, node, robot=item.robot, controller=item.controller, **more)  # type: ignore[arg-type]
        found.setdefault((kind, item.topic), endpoint)

    for published in built.published.values():
        add(PUBLISHED, published, rate=published.rate, latched=published.rate is None)
    for commanded in built.commanded.values():
        add(COMMANDED, commanded)
    for action in built.actions.values():
        add(ACTION, action)
    return tuple(found.values())


def _node(item: PublishedTopic | CommandTopic, namespace: str) -> str:
    """Return the node that a ROS user looks for."""
    if item.controller:
        return f"{namespace}/{item.controller}"
    is_description = item.topic.endswith("robot_description") or item.topic in ("/tf", "/tf_static")
    return f"{namespace}/robot_state_publisher" if is_description else TWIN_NODE
