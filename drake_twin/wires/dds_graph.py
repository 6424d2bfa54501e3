"""Who else is on the ROS 2 graph over DDS: what other participants tell of their nodes and writers."""

from time import monotonic
from typing import Any

from drake_twin.messages.interface_types import deserialize
from drake_twin.wires.rmw_dds_format import GRAPH_TOPIC, GRAPH_TYPE, ros_topic, sample_type

_MOST_SAMPLES = 1000
_PERIOD = 20_000_000  # ns between two looks
_DISCOVERY = 1.0  # s in which participants find one another


class DdsGraph:
    """Collects what other participants tell, from now on.

    Args:
        participant: The own participant.
    """

    def __init__(self, participant: Any):
        from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
        from cyclonedds.core import Policy, Qos, ReadCondition, SampleState, WaitSet
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic
        from cyclonedds.util import duration

        qos = Qos(
            Policy.Reliability.Reliable(max_blocking_time=duration(milliseconds=1)),
            Policy.Durability.TransientLocal,
            Policy.History.KeepAll,  # of all participants together: the topic has no key
            Policy.DataRepresentation(use_cdrv0_representation=True),
        )
        topic: Any = Topic(participant, GRAPH_TOPIC, sample_type(GRAPH_TYPE))
        self._graph: Any = DataReader(participant, topic, qos)
        self._publications: Any = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
        self._waiting: Any = WaitSet(participant)
        for reader in (self._graph, self._publications):
            self._waiting.attach(ReadCondition(reader, SampleState.NotRead))
        self._deadline = monotonic() + _DISCOVERY

    def topics_beside(self, node: str) -> list[str]:
        """Return the topics of participants with a node, after they have had time to tell of themselves.

        Args:
            node: The node's full name; one that the own participant has not told of.
        """
        names: dict[bytes, str] = {}  # the writers' GUIDs → their topics
        writers: set[bytes] = set()  # of participants with the node
        while True:
            for sample in self._graph.take(_MOST_SAMPLES):
                if data := getattr(sample, "data", b""):
                    writers |= _writers_beside(data, node)
            for item in self._publications.take(_MOST_SAMPLES):
                if name := getattr(item, "topic_name", None):
                    names[item.key.bytes] = name
            if (writers and writers <= names.keys()) or monotonic() >= self._deadline:
                topics = (ros_topic(names[writer]) for writer in writers if writer in names)
                return sorted(topic for topic in topics if topic)
            self._waiting.wait(_PERIOD)


def _writers_beside(data: bytes, node: str) -> set[bytes]:
    """Return the GUIDs of all writers of a participant that tells of a node; none of any other."""
    nodes = deserialize(GRAPH_TYPE, data).node_entities_info_seq
    if not any(f"{item.node_namespace.rstrip('/')}/{item.node_name}" == node for item in nodes):
        return set()
    return {bytes(gid.data) for item in nodes for gid in item.writer_gid_seq}
