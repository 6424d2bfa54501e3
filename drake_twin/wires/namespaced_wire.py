"""A wire on which all names of a twin begin with a namespace."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from drake_twin.wires.wire import AskingWire, Closable, Nothing, Reply, Sender, ServiceClient, WireEndpoint


class NamespacedWire:
    """Another wire, with a namespace before the names of topics, services and nodes.

    Args:
        wire: The wire, of a kind that sees the graph.
        namespace: The namespace, with a leading slash.

    Attributes:
        domain: The ROS domain.
    """

    def __init__(self, wire: Any, namespace: str):
        self._wire, self._namespace = wire, namespace
        self.domain: int = wire.domain

    def advertise(self, topic: WireEndpoint, listened: Callable[[bool], None]) -> Sender:
        """Offer a topic; see `drake_twin.wires.wire.Wire`."""
        sender: Sender = self._wire.advertise(self._named(topic), listened)
        return sender

    def listen(self, topic: WireEndpoint, heard: Callable[[bytes], None]) -> Closable:
        """Hear a topic; see `drake_twin.wires.wire.Wire`."""
        listener: Closable = self._wire.listen(self._named(topic), heard)
        return listener

    def serve(self, service: WireEndpoint, answer: Callable[[bytes, Reply], None]) -> Closable:
        """Offer a service; see `drake_twin.wires.wire.Wire`."""
        server: Closable = self._wire.serve(self._named(service), answer)
        return server

    def client(self, service: WireEndpoint, changed: Callable[[], None]) -> ServiceClient:
        """Look for a service of another program; see `drake_twin.wires.wire.AskingWire`."""
        return self._wire.client(self._named(service), changed) if isinstance(self._wire, AskingWire) else Nothing()

    def topics_beside(self, node: str) -> Sequence[str]:
        """Return the topics that other programs publish in which a node of this namespace runs, without it."""
        topics = self._wire.topics_beside(self._namespace + node)
        return [topic.removeprefix(self._namespace) for topic in topics]

    def close(self) -> None:
        """End the wire."""
        self._wire.close()

    def _named(self, endpoint: WireEndpoint) -> WireEndpoint:
        return replace(endpoint, name=self._namespace + endpoint.name, node=self._namespace + endpoint.node)
