"""What other programs have on the graph over DDS, what of it does not fit the twin's, and whether they are twins.

DDS connects a reader and a writer of one topic only if their types have the same name, and says nothing otherwise.
"""

import logging
from collections.abc import Iterable
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.messages.interface_types import deserialize, type_hash
from drake_twin.wires.dds_endpoints import matched, quality, reader
from drake_twin.wires.log_once import LogOnce
from drake_twin.wires.rmw_dds_format import GRAPH_TOPIC, GRAPH_TYPE, endpoint_data, read_endpoint_data, ros_topic
from drake_twin.wires.ros_names import dds_type, ros_type
from drake_twin.wires.wire import WireEndpoint

_log = logging.getLogger(__name__)
_MOST_SAMPLES = 1000
_MOST_LINES = 100  # of the log


@dataclass(frozen=True)
class End:
    """A reader or writer of the twin.

    Attributes:
        of: What it belongs to.
        topic: Its topic's DDS name.
        type: Its ROS type: the topic's, or that of the service's request or response.
        guid: The 16 bytes of its GUID.
        is_reader: Whether it reads.
    """

    of: WireEndpoint
    topic: str
    type: str
    guid: bytes
    is_reader: bool


@dataclass(frozen=True)
class _Foreign:
    """A reader or writer of another program, with DDS's name of its type."""

    topic: str
    type: str
    hash: str


class Discovery:
    """The readers, writers and nodes of other participants.

    Args:
        participant: The participant.

    Attributes:
        conditions: The conditions that something has come or gone.
    """

    def __init__(self, participant: Any):
        from cyclonedds import builtin
        from cyclonedds.core import ReadCondition, SampleState

        self._own = participant.guid
        topics = builtin.BuiltinTopicDcpsSubscription, builtin.BuiltinTopicDcpsPublication
        self._readers = [builtin.BuiltinDataReader(participant, topic) for topic in topics]
        self.conditions = [ReadCondition(reader, SampleState.NotRead) for reader in self._readers]
        self._found: tuple[dict[Any, _Foreign], dict[Any, _Foreign]] = {}, {}  # readers, writers
        qos = quality(endpoint_data(type_hash(GRAPH_TYPE)), latched=True, depth=None)  # the topic has no key
        self._graph, condition = reader(participant, GRAPH_TOPIC, GRAPH_TYPE, qos)
        self.conditions.append(condition)
        self._nodes: dict[int, bytes] = {}  # writer → what its participant has told last of its nodes
        self._tell = LogOnce(_log, most=_MOST_LINES)

    def take(self) -> int:
        """Take note of what has come and gone; return how many of the conditions were met."""
        count = sum(self._take(reader, found) for reader, found in zip(self._readers, self._found, strict=True))
        return count + self._take_nodes()

    def topics_beside(self, node: str) -> list[str]:
        """Return the topics of ROS that other participants with a node publish.

        Args:
            node: The node's full name.
        """
        writers = {writer for data in self._nodes.values() for writer in _writers_beside(data, node)}
        topics = (ros_topic(item.topic) for key, item in self._found[1].items() if key.bytes in writers)
        return sorted(filter(None, topics))

    def tell(self, ends: Iterable[End]) -> None:
        """Log which readers and writers of others are not connected with these, or differ, because of their types."""
        readers, writers = ({(item.topic, item.type, item.hash) for item in found.values()} for found in self._found)
        foreign: dict[tuple[str, bool], list[_Foreign]] = {}
        for is_reader, items in ((True, readers), (False, writers)):
            for item in items:
                foreign.setdefault((item[0], is_reader), []).append(_Foreign(*item))
        for end in ends:
            for other in foreign.get((end.topic, not end.is_reader), ()):
                if problem := _problem(end, other):
                    self._tell(f"{end.of.name}: {problem}")

    def _take(self, reader: Any, found: dict[Any, _Foreign]) -> bool:
        from cyclonedds.core import InstanceState

        samples = reader.take(_MOST_SAMPLES)
        for sample in samples:
            info = sample.sample_info
            if not info.valid_data or info.instance_state != InstanceState.Alive:
                found.pop(sample.key, None)
            elif sample.participant_key != self._own:
                found[sample.key] = _Foreign(sample.topic_name, sample.type_name, _hash(sample.qos))
        return bool(samples)

    def _take_nodes(self) -> bool:
        samples = self._graph.take(_MOST_SAMPLES)  # one without data is about a participant that has gone
        told = {item.sample_info.publication_handle: item.data for item in samples if getattr(item, "data", b"")}
        known = matched(self._graph.get_matched_publications)  # among them those that have told now may be later
        self._nodes = {writer: data for writer, data in self._nodes.items() if writer in known} | told
        return bool(samples)


def _writers_beside(data: bytes, node: str) -> set[bytes]:
    """Return the GUIDs of all writers of a participant that tells of a node; none of any other."""
    try:
        nodes = deserialize(GRAPH_TYPE, data).node_entities_info_seq
    except ValueError:  # of another release of ROS 2, or of no ROS
        return set()
    if not any(f"{item.node_namespace.rstrip('/')}/{item.node_name}" == node for item in nodes):
        return set()
    return {bytes(gid.data) for item in nodes for gid in item.writer_gid_seq}


def _problem(end: End, other: _Foreign) -> str | None:
    """Return why a reader or writer of another program gets nothing from the twin's, or something else than it says."""
    is_service = end.topic.startswith(("rq/", "rr/"))
    if other.type != dds_type(end.type):
        theirs = ros_type(other.type)
        if is_service:
            return f"another program calls it as {_of_service(theirs)}, but its type is {_of_service(end.type)}"
        does = "publishes" if end.is_reader else "subscribes to"
        return f"another program {does} {theirs}, but the topic's type is {end.type}"
    if other.hash and (own := _own_hash(end.type)) and other.hash != own:
        return f"the {end.type} of another program is another one, with the hash {other.hash}"
    return None


def _of_service(kind: str) -> str:
    return kind.removesuffix("_Request").removesuffix("_Response")


def _own_hash(kind: str) -> str:
    try:
        return type_hash(kind)
    except ValueError:
        return ""


def _hash(qos: Any) -> str:
    from cyclonedds.core import Policy

    data = qos[Policy.Userdata]
    return "" if data is None else read_endpoint_data(data.data).get("typehash", "")
