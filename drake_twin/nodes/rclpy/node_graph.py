"""What a node asks of the graph: who publishes, subscribes, offers and asks."""

from collections.abc import Callable, Iterable
from hashlib import sha256
from itertools import chain
from typing import Any

from drake_twin.nodes.graph import Graph
from drake_twin.nodes.graph_lists import hearing, publishers_of, publishing, subscribers_of
from drake_twin.nodes.rclpy._rclpy_pybind11 import NodeNameNonExistentError, RCLError
from drake_twin.nodes.rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from drake_twin.nodes.rclpy.expand_topic_name import expand_topic_name
from drake_twin.nodes.rclpy.handle import NodeHandle
from drake_twin.nodes.rclpy.name_rules import full_topic_problem, namespace_problem, node_problem
from drake_twin.nodes.rclpy.qos_compatibility import as_seen, profile_of
from drake_twin.nodes.rclpy.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum
from drake_twin.nodes.rclpy.type_hash import TypeHash
from drake_twin.nodes.simulated_time import wait_until
from drake_twin.nodes.task import present_task
from drake_twin.ros2.launched import remapped
from drake_twin.twin.endpoints import Endpoint

_EVENTS = ("/parameter_events", "rcl_interfaces/msg/ParameterEvent")
_LOG = ("/rosout", "rcl_interfaces/msg/Log")
_Names = list[tuple[str, list[str]]]


class NodeGraph:
    """The part of a node that asks for what is on the graph."""

    _twin_graph: Graph
    _twin_actions: Any
    _twin_handle: NodeHandle
    _context: Any
    _twin_name: str
    _twin_namespace: str
    _twin_full: str
    _twin_arguments: Any

    # Names and types -------------------------------------------------------------------------------------------------

    def get_topic_names_and_types(self, no_demangle: bool = False) -> _Names:
        self._twin_looked("topic names and types")
        topics = self._twin_graph.topics()
        if any(self._twin_graph.node_logs.values()):
            topics.setdefault(_LOG[0], [_LOG[1]])
        for name, kinds in self._twin_actions.names():
            topics.setdefault(f"{name}/_action/feedback", [f"{each}_FeedbackMessage" for each in kinds])
            topics.setdefault(f"{name}/_action/status", ["action_msgs/msg/GoalStatusArray"])
        found = sorted({_EVENTS[0]: [_EVENTS[1]], **topics}.items())
        if not no_demangle:
            return found
        return [(f"rt{name}", [_dds_name(kind) for kind in kinds]) for name, kinds in found]

    def get_service_names_and_types(self) -> _Names:
        self._twin_looked("service names and types")
        found = dict(self._twin_graph.service_names())
        for name, kinds in self._twin_actions.names():
            for part, kind in (("send_goal", "_SendGoal"), ("get_result", "_GetResult")):
                found[f"{name}/_action/{part}"] = [f"{each}{kind}" for each in kinds]
            found[f"{name}/_action/cancel_goal"] = ["action_msgs/srv/CancelGoal"]
        return sorted(found.items())

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> _Names:
        node = self._twin_known_node(node_name, node_namespace, "publisher")
        found = self._twin_topics_of(publishers_of, node)
        logs = self._twin_graph.node_logs.get(node)
        every = {} if logs is None else {_EVENTS[0]: [_EVENTS[1]]}
        return sorted((dict(found) | every | ({_LOG[0]: [_LOG[1]]} if logs else {})).items())

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> _Names:
        return self._twin_topics_of(subscribers_of, self._twin_known_node(node_name, node_namespace, "subscriber"))

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> _Names:
        node = self._twin_known_node(node_name, node_namespace, "service")
        return [(name, [kind]) for name, of, kind in self._twin_offers() if of == node]

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> _Names:
        node = self._twin_known_node(node_name, node_namespace, "client")
        return sorted(
            {item.name: [item.type] for item in self._twin_graph.outside.callers if item.node == node}.items()
        )

    # Nodes -----------------------------------------------------------------------------------------------------------

    def get_node_names(self) -> list[str]:
        return [name for name, _ in self.get_node_names_and_namespaces()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        self._twin_looked("node names")
        return [(name.rpartition("/")[2], name.rpartition("/")[0] or "/") for name in self._twin_graph.node_names()]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        return [(name, namespace, "/") for name, namespace in self.get_node_names_and_namespaces()]

    def get_fully_qualified_node_names(self) -> list[str]:
        return [f"{namespace.rstrip('/')}/{name}" for name, namespace in self.get_node_names_and_namespaces()]

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        name = "/" + fully_qualified_node_name.lstrip("/")
        return wait_until(present_task(), lambda: name in self._twin_graph.node_names(), timeout)

    # Numbers ---------------------------------------------------------------------------------------------------------

    def count_publishers(self, topic_name: str) -> int:
        return len(publishing(self._twin_graph, self._twin_expanded(topic_name)))

    def count_subscribers(self, topic_name: str) -> int:
        return len(hearing(self._twin_graph, self._twin_expanded(topic_name)))

    def count_services(self, service_name: str) -> int:
        name = self._twin_expanded(service_name, is_service=True)
        return sum(name == each for each, _, _ in self._twin_offers())

    def count_clients(self, service_name: str) -> int:
        name = self._twin_expanded(service_name, is_service=True)
        return sum(name == item.name for item in self._twin_graph.outside.callers)

    # Endpoints -------------------------------------------------------------------------------------------------------

    def get_publishers_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[TopicEndpointInfo]:
        return self._twin_infos(publishing, topic_name, no_mangle, TopicEndpointTypeEnum.PUBLISHER)

    def get_subscriptions_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[TopicEndpointInfo]:
        return self._twin_infos(hearing, topic_name, no_mangle, TopicEndpointTypeEnum.SUBSCRIPTION)

    def _twin_infos(
        self, of: Callable[[Graph, str], Iterable[Any]], name: str, no_mangle: bool, kind: TopicEndpointTypeEnum
    ) -> list[TopicEndpointInfo]:
        if not no_mangle:
            name = remapped(
                self._twin_expanded(name), self._twin_namespace, self._twin_full, self._twin_arguments.remappings
            )
        infos = []
        for number, item in enumerate(of(self._twin_graph, name)):
            namespace, _, node = item.node.rpartition("/")
            given = profile_of(item) if isinstance(item, Endpoint) else item.profile
            gid = sha256(f"{item.node} {name} {kind} {number}".encode()).digest()[:16]
            infos.append(
                TopicEndpointInfo(
                    node_name=node,
                    node_namespace=namespace or "/",
                    topic_type=item.type,
                    topic_type_hash=_hash_of(item.type),
                    endpoint_type=kind,
                    endpoint_gid=list(gid),
                    qos_profile=as_seen(given, is_publisher=kind is TopicEndpointTypeEnum.PUBLISHER),
                )
            )
        return infos

    # -----------------------------------------------------------------------------------------------------------------

    def _twin_looked(self, what: str) -> None:
        """Count a look at the graph; raise an error if it cannot be looked at any more."""
        present_task().count_idle_call()
        self._twin_handle.check()
        if not self._context.is_valid:
            raise RCLError(f"Failed to get {what}: rcl node's context is invalid")

    def _twin_known_node(self, name: str, namespace: str, what: str) -> str:
        self._twin_looked(f"{what} names and types")
        if problem := node_problem(name) or namespace_problem(namespace):
            raise RCLError(f"failed to get {what} names and types: {problem[0]}")
        node = f"{namespace.rstrip('/')}/{name}"
        if node not in self._twin_graph.node_names():
            raise NodeNameNonExistentError(f"cannot get {what} names and types for nonexistent node: {node}")
        return node

    def _twin_expanded(self, name: str, *, is_service: bool = False) -> str:
        self._twin_looked("counts")
        full = expand_topic_name(name, self._twin_name, self._twin_namespace)
        if problem := full_topic_problem(full):
            raise (InvalidServiceNameException if is_service else InvalidTopicNameException)(full, *problem)
        return full

    def _twin_offers(self) -> list[tuple[str, str, str]]:
        """Return name, node and type of each service that is offered."""
        twins = [(item.name, item.node, item.type) for item in self._twin_graph.services().values()]
        return sorted(twins + [(item.name, item.node, item.type) for item in chain(*self._twin_graph.offers.values())])

    def _twin_topics_of(self, of: Callable[[Graph, str], list[tuple[str, str]]], node: str) -> _Names:
        found = []
        for topic in self._twin_graph.topics():
            kinds = sorted({kind for each, kind in of(self._twin_graph, topic) if each == node})
            if kinds:
                found.append((topic, kinds))
        return found


def _dds_name(kind: str) -> str:
    return f"{kind.replace('/', '::').replace('::msg::', '::msg::dds_::')}_"


def _hash_of(kind: str) -> TypeHash:
    from drake_twin.messages.interface_types import type_hash

    text = type_hash(kind)
    return TypeHash(1, bytes.fromhex(text.removeprefix("RIHS01_")))
