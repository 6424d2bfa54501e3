"""What a wire is: it carries bytes of topics and services to and from other programs."""

import contextlib
from collections.abc import Callable, Iterable
from typing import Protocol, runtime_checkable

from drake_twin.dataclass import dataclass

Reply = Callable[[bytes], None]
LARGEST = 1 << 20  # bytes of a command and of a request
LARGEST_OF_NODES = 64 << 20  # bytes of a message for nodes: a picture of 4K has 25 MB


@dataclass(frozen=True)
class WireEndpoint:
    """A topic or a service as a wire sees it.

    Attributes:
        name: Its full name.
        type: Its ROS type.
        hash: The type's hash, ``RIHS01_…``; empty if it is not known.
        node: The full name of its node.
        latched: Whether late joiners get the last message of the topic.
        is_best_effort: Whether messages of the topic may be lost.
        definition: The text of the topic's message type, with those of the messages in it.
        depth: How many messages of the topic are kept for who is slow or late; 0 for what suits it.
        lifespan: How long they are kept (s); None for always.
        keeps_all: Whether all messages are kept, whatever the depth.
        deadline: The longest time between messages that is offered, or requested (s); None for any.
        is_manual: Whether the publisher says itself that it is alive, with each message.
        lease: The time in which it has to (s); None for any.
        of_all_nodes: Whether each node of the program publishes the topic, beside its own.
        largest: How many bytes a message of the topic has at most that is heard.
    """

    name: str
    type: str
    hash: str
    node: str
    latched: bool = False
    definition: str = ""
    is_best_effort: bool = False
    depth: int = 0
    lifespan: float | None = None
    keeps_all: bool = False
    deadline: float | None = None
    is_manual: bool = False
    lease: float | None = None
    of_all_nodes: bool = False
    largest: int = LARGEST

    @property
    def kept(self) -> int:
        """How many messages of the topic are kept."""
        return self.depth or (1 if self.latched else 10)


class Sender(Protocol):
    """Sends the messages of a topic.

    Attributes:
        is_heard: Whether anybody listens.
    """

    is_heard: bool

    def send(self, data: bytes, time: int) -> None:
        """Send a message, in the sender's thread.

        Args:
            data: Its CDR bytes.
            time: The simulation time at which it was published (ns).
        """

    def close(self) -> None:
        """End the topic."""


class Closable(Protocol):
    """What can be ended."""

    def close(self) -> None:
        """End it."""


class ServiceClient(Closable, Protocol):
    """Asks a service of another program.

    Attributes:
        is_there: Whether the service is there.
    """

    is_there: bool

    def ask(self, request: bytes, answered: Reply) -> None:
        """Send a request.

        Args:
            request: Its CDR bytes.
            answered: Is called with the response's, in a thread of the wire; not if the service does not answer.
        """


@runtime_checkable
class AskingWire(Protocol):
    """A wire over which the services of other programs can be asked, beside what is in `Wire`."""

    def client(self, service: WireEndpoint, changed: Callable[[], None]) -> ServiceClient:
        """Look for a service of another program.

        Args:
            service: The service, with the node that asks it.
            changed: Is called when the service comes and goes, in a thread of the wire.
        """


class Wire(Protocol):
    """A wire. All methods are called in the thread that owns the twin, callbacks come in threads of the wire."""

    def advertise(self, topic: WireEndpoint, listened: Callable[[bool], None]) -> Sender:
        """Offer a topic.

        Args:
            topic: The topic.
            listened: Is called with whether anybody listens, whenever that changes.
        """

    def listen(self, topic: WireEndpoint, heard: Callable[[bytes], None]) -> Closable:
        """Hear a topic.

        Args:
            topic: The topic.
            heard: Is called with each message's CDR bytes.
        """

    def serve(self, service: WireEndpoint, answer: Callable[[bytes, Reply], None]) -> Closable:
        """Offer a service.

        Args:
            service: The service.
            answer: Is called with each request's CDR bytes and a function that takes the response's, once, from any
                thread.
        """

    def close(self) -> None:
        """End the wire.

        Raises:
            RunError: If it has lost messages that it was to keep.
        """


def close_all(wires: Iterable[Wire]) -> None:
    """End wires, each of them.

    Raises:
        RunError: If one has lost messages that it was to keep.
    """
    with contextlib.ExitStack() as stack:
        for wire in wires:
            stack.callback(wire.close)


class Nothing:
    """Stands for the sender, the end or the client of what a wire does not carry."""

    is_heard = is_there = False

    def send(self, data: bytes, time: int) -> None:
        """Send nothing."""

    def ask(self, request: bytes, answered: Reply) -> None:
        """Ask nobody."""

    def close(self) -> None:
        """Nothing is to be ended."""
