"""Who publishes and who hears a topic."""

from drake_twin.nodes.graph import Graph
from drake_twin.nodes.graph_items import Publication, Reception
from drake_twin.twin.endpoints import Endpoint


def publishing(graph: Graph, topic: str) -> list[Endpoint | Publication | Reception]:
    """Return the publishers of a topic: the twin's, and those of nodes."""
    return [item for item in (graph._published.get(topic), *graph.publications.get(topic, ())) if item is not None]


def hearing(graph: Graph, topic: str) -> list[Endpoint | Publication | Reception]:
    """Return the subscribers of a topic: the twin's, and those of nodes."""
    return [item for item in (graph._commanded.get(topic), *graph.receptions.get(topic, ())) if item is not None]


def publishers_of(graph: Graph, topic: str) -> list[tuple[str, str]]:
    """Return node and type of each publisher of a topic."""
    return [(item.node, item.type) for item in publishing(graph, topic)]


def subscribers_of(graph: Graph, topic: str) -> list[tuple[str, str]]:
    """Return node and type of each subscriber of a topic."""
    return [(item.node, item.type) for item in hearing(graph, topic)]


def count_matched(item: Publication | Reception) -> int:
    """Return how many hear a publisher, or are heard by a subscription."""
    twins = item.command if isinstance(item, Publication) else item.end
    return len(item.matched) + (twins is not None)
