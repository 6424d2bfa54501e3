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
from drake_twin.nodes.rclpy.name_rules import full_topic_problem, namespace_problem, node_problem
from drake_twin.nodes.rclpy.node_handle import NodeHandle
from drake_twin.nodes.rclpy.qos_compatibility import as_seen, profile_of
from drake_twin.nodes.rclpy.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum
from drake_twin.nodes.rclpy.type_hash import TypeHash
from drake_twin.nodes.simulated_time import wait_until
from drake_twin.nodes.task import present_task
from drake_twin.twin.endpoints import Endpoint

_EVENTS = ("/parameter_events", "rcl_interfaces/msg/ParameterEvent")
_LOG = ("/rosout", "rcl_interfaces/msg/Log")
_Names = list[tuple[str, list[str]]]


class NodeGraph:
    """The part of a node that asks for what is on the graph."""

    handle: Any

    # Names and types -------------------------------------------------------------------------------------------------

    def get_topic_names_and_types(self, no_demangle: bool = False) -> _Names:
        looked(self.handle, "topic names and types")
        topics = self.handle.graph.topics()
        if any(self.handle.graph.node_logs.values()):
            topics.setdefault(_LOG[0], [_LOG[1]])
        for name, kinds in self.handle.actions.names():
            topics.setdefault(f"{name}/_action/feedback", [f"{each}_FeedbackMessage" for each in kinds])
            topics.setdefault(f"{name}/_action/status", ["action_msgs/msg/GoalStatusArray"])
        found = sorted({_EVENTS[0]: [_EVENTS[1]], **topics}.items())
        if not no_demangle:
            return found
        return [(f"rt{name}", [_dds_name(kind) for kind in kinds]) for name, kinds in found]

    def get_service_names_and_types(self) -> _Names:
        looked(self.handle, "service names and types")
        found = dict(self.handle.graph.service_names())
        for name, kinds in self.handle.actions.names():
            for part, kind in (("send_goal", "_SendGoal"), ("get_result", "_GetResult")):
                found[f"{name}/_action/{part}"] = [f"{each}{kind}" for each in kinds]
            found[f"{name}/_action/cancel_goal"] = ["action_msgs/srv/CancelGoal"]
        return sorted(found.items())

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> _Names:
        node = known_node(self.handle, node_name, node_namespace, "publisher")
        found = _topics_of(self.handle, publishers_of, node)
        logs = self.handle.graph.node_logs.get(node)
        every = {} if logs is None else {_EVENTS[0]: [_EVENTS[1]]}
        return sorted((dict(found) | every | ({_LOG[0]: [_LOG[1]]} if logs else {})).items())

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> _Names:
        return _topics_of(self.handle, subscribers_of, known_node(self.handle, node_name, node_namespace, "subscriber"))

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> _Names:
        node = known_node(self.handle, node_name, node_namespace, "service")
        return [(name, [kind]) for name, of, kind in _offers(self.handle.graph) if of == node]

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> _Names:
        node = known_node(self.handle, node_name, node_namespace, "client")
        return sorted(
            {item.name: [item.type] for item in self.handle.graph.outside.callers if item.node == node}.items()
        )

    # Nodes -----------------------------------------------------------------------------------------------------------

    def get_node_names(self) -> list[str]:
        return [name for name, _ in self.get_node_names_and_namespaces()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        looked(self.handle, "node names")
        return [(name.rpartition("/")[2], name.rpartition("/")[0] or "/") for name in self.handle.graph.node_names()]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        return [(name, namespace, "/") for name, namespace in self.get_node_names_and_namespaces()]

    def get_fully_qualified_node_names(self) -> list[str]:
        return [f"{namespace.rstrip('/')}/{name}" for name, namespace in self.get_node_names_and_namespaces()]

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        name = "/" + fully_qualified_node_name.lstrip("/")
        return wait_until(present_task(), lambda: name in self.handle.graph.node_names(), timeout)

    # Numbers ---------------------------------------------------------------------------------------------------------

    def count_publishers(self, topic_name: str) -> int:
        return len(publishing(self.handle.graph, _expanded(self.handle, topic_name)))

    def count_subscribers(self, topic_name: str) -> int:
        return len(hearing(self.handle.graph, _expanded(self.handle, topic_name)))

    def count_services(self, service_name: str) -> int:
        name = _expanded(self.handle, service_name, is_service=True)
        return sum(name == each for each, _, _ in _offers(self.handle.graph))

    def count_clients(self, service_name: str) -> int:
        name = _expanded(self.handle, service_name, is_service=True)
        return sum(name == item.name for item in self.handle.graph.outside.callers)

    # Endpoints -------------------------------------------------------------------------------------------------------

    def get_publishers_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[TopicEndpointInfo]:
        return _infos(self.handle, publishing, topic_name, no_mangle, TopicEndpointTypeEnum.PUBLISHER)

    def get_subscriptions_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[TopicEndpointInfo]:
        return _infos(self.handle, hearing, topic_name, no_mangle, TopicEndpointTypeEnum.SUBSCRIPTION)


def looked(node: NodeHandle, what: str) -> None:
    """Count a look at the graph; raise an error if it cannot be looked at any more."""
    present_task().count_idle_call()
    node.check()
    if not node.context.is_valid:
        raise RCLError(f"Failed to get {what}: rcl node's context is invalid")


def known_node(node: NodeHandle, name: str, namespace: str, what: str) -> str:
    """Return the full name of a node that is on the graph.

    Raises:
        RCLError: If ROS does not accept the name.
        NodeNameNonExistentError: If the graph lacks it.
    """
    looked(node, f"{what} names and types")
    if problem := node_problem(name) or namespace_problem(namespace):
        raise RCLError(f"failed to get {what} names and types: {problem[0]}")
    full = f"{namespace.rstrip('/')}/{name}"
    if full not in node.graph.node_names():
        raise NodeNameNonExistentError(f"cannot get {what} names and types for nonexistent node: {full}")
    return full


def _infos(
    node: NodeHandle,
    of: Callable[[Graph, str], Iterable[Any]],
    name: str,
    no_mangle: bool,
    kind: TopicEndpointTypeEnum,
) -> list[TopicEndpointInfo]:
    if not no_mangle:
        name = node.remapped(_expanded(node, name))
    infos = []
    for number, item in enumerate(of(node.graph, name)):
        namespace, _, base = item.node.rpartition("/")
        given = profile_of(item) if isinstance(item, Endpoint) else item.profile
        gid = sha256(f"{item.node} {name} {kind} {number}".encode()).digest()[:16]
        infos.append(
            TopicEndpointInfo(
                node_name=base,
                node_namespace=namespace or "/",
                topic_type=item.type,
                topic_type_hash=_hash_of(item.type),
                endpoint_type=kind,
                endpoint_gid=list(gid),
                qos_profile=as_seen(given, is_publisher=kind is TopicEndpointTypeEnum.PUBLISHER),
            )
        )
    return infos


def _expanded(node: NodeHandle, name: str, *, is_service: bool = False) -> str:
    looked(node, "counts")
    full = expand_topic_name(name, node.base, node.namespace)
    if problem := full_topic_problem(full):
        raise (InvalidServiceNameException if is_service else InvalidTopicNameException)(full, *problem)
    return full


def _offers(graph: Graph) -> list[tuple[str, str, str]]:
    """Return name, node and type of each service that is offered."""
    twins = [(item.name, item.node, item.type) for item in graph.services().values()]
    return sorted(twins + [(item.name, item.node, item.type) for item in chain(*graph.offers.values())])


def _topics_of(node: NodeHandle, of: Callable[[Graph, str], list[tuple[str, str]]], name: str) -> _Names:
    found = []
    for topic in node.graph.topics():
        kinds = sorted({kind for each, kind in of(node.graph, topic) if each == name})
        if kinds:
            found.append((topic, kinds))
    return found


def _dds_name(kind: str) -> str:
    return f"{kind.replace('/', '::').replace('::msg::', '::msg::dds_::')}_"


def _hash_of(kind: str) -> TypeHash:
    from drake_twin.messages.interface_types import type_hash

    text = type_hash(kind)
    return TypeHash(1, bytes.fromhex(text.removeprefix("RIHS01_")))
