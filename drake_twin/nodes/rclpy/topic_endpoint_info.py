"""Stand-in for ``rclpy.topic_endpoint_info``, and what nodes ask of the graph about each other."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from enum import IntEnum
from itertools import chain

from drake_twin.nodes.graph import Graph, hearing, publishing
from drake_twin.nodes.graph_items import Publication, Reception
from drake_twin.nodes.rclpy.duration import Duration
from drake_twin.nodes.rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, as_seen
from drake_twin.nodes.task import present_task
from drake_twin.twin.endpoints import Endpoint


class TopicEndpointTypeEnum(IntEnum):
    """What an endpoint does."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


@dataclass
class TopicEndpointInfo:
    """A publisher or a subscription of a topic."""

    node_name: str
    node_namespace: str
    topic_type: str
    endpoint_type: TopicEndpointTypeEnum
    qos_profile: QoSProfile = field(default_factory=lambda: QoSProfile(depth=10))
    endpoint_gid: list[int] = field(default_factory=lambda: [0] * 16)


class GraphQueries:
    """The part of a node that asks what the nodes of the graph publish, subscribe to and offer."""

    _graph: Graph

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return a topic's full name."""
        raise NotImplementedError

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """Return a service's full name."""
        raise NotImplementedError

    def get_publishers_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[TopicEndpointInfo]:
        topic = self.resolve_topic_name(topic_name)
        return self._infos(publishing(self._graph, topic), TopicEndpointTypeEnum.PUBLISHER)

    def get_subscriptions_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[TopicEndpointInfo]:
        topic = self.resolve_topic_name(topic_name)
        return self._infos(hearing(self._graph, topic), TopicEndpointTypeEnum.SUBSCRIPTION)

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> list[tuple[str, list[str]]]:
        node = f"{node_namespace.rstrip('/')}/{node_name}"
        return self._topics_of(self._graph.publishers_of, node)

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> list[tuple[str, list[str]]]:
        node = f"{node_namespace.rstrip('/')}/{node_name}"
        return self._topics_of(self._graph.subscribers_of, node)

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> list[tuple[str, list[str]]]:
        present_task().count_idle_call()
        node = f"{node_namespace.rstrip('/')}/{node_name}"
        return [(name, [kind]) for name, of, kind in self._offers() if of == node]

    def count_services(self, service_name: str) -> int:
        present_task().count_idle_call()
        name = self.resolve_service_name(service_name)
        return sum(name == each for each, _, _ in self._offers())

    def _infos(
        self, found: Iterable[Endpoint | Publication | Reception], kind: TopicEndpointTypeEnum
    ) -> list[TopicEndpointInfo]:
        present_task().count_idle_call()
        infos = []
        for item in found:
            namespace, _, name = item.node.rpartition("/")
            given = _profile_of(item) if isinstance(item, Endpoint) else item.profile
            seen = as_seen(given or QoSProfile(depth=10), is_publisher=kind is TopicEndpointTypeEnum.PUBLISHER)
            infos.append(TopicEndpointInfo(name, namespace or "/", item.type, kind, seen))
        return infos

    def _offers(self) -> list[tuple[str, str, str]]:
        """Return name, node and type of each service that is offered."""
        twins = [(item.name, item.node, item.type) for item in self._graph.services().values()]
        return sorted(twins + [(item.name, item.node, item.type) for item in chain(*self._graph.offers.values())])

    def _topics_of(self, of: Callable[[str], list[tuple[str, str]]], node: str) -> list[tuple[str, list[str]]]:
        present_task().count_idle_call()
        found = []
        for topic in self._graph.topics():
            kinds = sorted({kind for each, kind in of(topic) if each == node})
            if kinds:
                found.append((topic, kinds))
        return found


def _profile_of(item: Endpoint) -> QoSProfile:
    """Return the quality of service of a topic of the twin."""
    return QoSProfile(
        depth=item.depth or (1 if item.latched else 10),
        reliability=ReliabilityPolicy.BEST_EFFORT if item.is_best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if item.latched else DurabilityPolicy.VOLATILE,
        lifespan=None if item.lifespan is None else Duration(seconds=item.lifespan),
    )
