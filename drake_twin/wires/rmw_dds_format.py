"""ROS 2 over DDS: topics' names, types, user data, the graph, and CycloneDDS's configuration.

Nothing here opens a participant. The upstream sources are ``rmw_node.cpp`` and ``serdata.cpp`` of rmw_cyclonedds_cpp,
``qos.hpp`` and ``ParticipantEntitiesInfo.msg`` of rmw_dds_common.

A service is two topics, as rmw_cyclonedds_cpp has it: before the request and before the response stand 16 bytes, which
the client chooses and the server repeats. rmw_fastrtps_cpp and rmw_connextdds keep that outside of the data.
"""

import re
import struct
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.messages.interface_types import fields_of, make, serialize
from drake_twin.wires.ros_names import dds_type
from drake_twin.wires.wire import LARGEST_OF_NODES

GRAPH_TOPIC = "ros_discovery_info"
GRAPH_TYPE = "rmw_dds_common/msg/ParticipantEntitiesInfo"
PARTICIPANT_DATA = b"enclave=/;"
LARGEST_SAMPLE = LARGEST_OF_NODES + 4096  # bytes, in either direction
_HEADER, _BIG_ENDIAN_HEADER = struct.Struct("<Qq"), struct.Struct(">Qq")
_LONGEST_INDEX = 32  # of a participant on one machine, as rmw_cyclonedds_cpp has it


@dataclass(frozen=True)
class NodeEndpoints:
    """The endpoints of a node on the graph.

    Attributes:
        readers: The 16 bytes of each reader's GUID.
        writers: The 16 bytes of each writer's GUID.
    """

    readers: tuple[bytes, ...] = ()
    writers: tuple[bytes, ...] = ()


def topic_name(topic: str) -> str:
    """Return the DDS name of a topic: ``rt/robot_1/joint_states`` for ``/robot_1/joint_states``."""
    return f"rt{topic}"


def ros_topic(name: str) -> str:
    """Return the topic with a DDS name; empty if it is not a topic of ROS."""
    return name.removeprefix("rt") if name.startswith("rt/") else ""


def request_topic(service: str) -> str:
    """Return the DDS name of the topic of a service's requests."""
    return f"rq{service}Request"


def response_topic(service: str) -> str:
    """Return the DDS name of the topic of a service's responses."""
    return f"rr{service}Reply"


def endpoint_data(type_hash: str, **more: str) -> bytes:
    """Return the user data of a reader or writer: the type's hash, after what else is given."""
    if type_hash:
        more["typehash"] = type_hash
    return "".join(f"{key}={value};" for key, value in more.items()).encode()


def read_endpoint_data(data: bytes) -> dict[str, str]:
    """Return what the user data of a reader or writer says; it may be another program's, and nothing of ROS."""
    return dict(re.findall(r"(\w+)=([^;]*);", data.decode(errors="replace")))


def service_id(participant: bytes, number: int) -> str:
    """Return what tells that two endpoints are those of one service or one client.

    Args:
        participant: The 16 bytes of the participant's GUID.
        number: The number of the service or client within the participant.
    """
    return ".".join(f"{item:x}" for item in (*participant[:12], *number.to_bytes(4, "big")))


def with_header(client: int, number: int, data: bytes) -> bytes:
    """Return a request or response as it is sent.

    Args:
        client: What the client is called by itself.
        number: The number of the request.
        data: Its CDR bytes.
    """
    return data[:4] + _HEADER.pack(client, number) + data[4:]


def without_header(data: bytes) -> tuple[int, int, bytes]:
    """Return client, number and CDR bytes of a request or response that has come.

    Raises:
        ValueError: If it is too short.
    """
    if len(data) < 4 + _HEADER.size:
        raise ValueError(f"{len(data)} bytes are too few for the header of rmw_cyclonedds_cpp")
    header = _HEADER if data[1] & 1 else _BIG_ENDIAN_HEADER
    client, number = header.unpack_from(data, 4)
    return client, number, data[:4] + data[4 + header.size :]


def graph_message(participant: bytes, nodes: Mapping[str, NodeEndpoints]) -> bytes:
    """Return the CDR bytes that tell a participant's nodes and their endpoints.

    Args:
        participant: The 16 bytes of the participant's GUID.
        nodes: The full name of each node → its endpoints.
    """
    fields = {
        "gid": _gid(participant),
        "node_entities_info_seq": [
            {
                "node_namespace": name.rpartition("/")[0] or "/",
                "node_name": name.rpartition("/")[2],
                "reader_gid_seq": [_gid(item) for item in endpoints.readers],
                "writer_gid_seq": [_gid(item) for item in endpoints.writers],
            }
            for name, endpoints in nodes.items()
        ],
    }
    return serialize(make(GRAPH_TYPE, fields))


def configuration(address: str, *, multicast: bool) -> str:
    """Return CycloneDDS's configuration for one network interface.

    Without multicast other participants are looked for on this machine, by the ports of their numbers.
    """
    interface = f'<NetworkInterface address="{address}" multicast="{str(multicast).lower()}"/>'
    discovery = "" if multicast else f'<Peers><Peer address="{address}"/></Peers>'
    return (
        "<CycloneDDS><Domain>"
        f"<General><Interfaces>{interface}</Interfaces>"
        f"<AllowMulticast>{'default' if multicast else 'false'}</AllowMulticast></General>"
        f"<Discovery><ParticipantIndex>auto</ParticipantIndex>"
        f"<MaxAutoParticipantIndex>{_LONGEST_INDEX}</MaxAutoParticipantIndex>{discovery}</Discovery>"
        f"<Internal><MaxSampleSize>{LARGEST_SAMPLE} B</MaxSampleSize></Internal>"
        "</Domain></CycloneDDS>"
    )


def sample_type(ros_type: str, *, has_header: bool = False) -> Any:
    """Return CycloneDDS's class for a message type, whose instances hold the message's CDR bytes as they are.

    Args:
        ros_type: The type.
        has_header: Whether the header of a request or response stands before it.

    Raises:
        ValueError: If the type is unknown, or DDS in Python does not have one of its parts.
    """
    return _sample_type(ros_type, has_header)


@cache
def _sample_type(ros_type: str, has_header: bool) -> Any:
    described = _struct(ros_type, has_header)

    class Sample(described):  # type: ignore[misc, valid-type]
        """A message's bytes, with the header of four bytes."""

        def __init__(self, data: bytes):
            self.data = data

        def serialize(self, *_: Any, **__: Any) -> bytes:
            return self.data

        @classmethod
        def deserialize(cls, data: bytes, *_: Any, **__: Any) -> "Sample":
            return cls(bytes(data))

        @classmethod
        def deserialize_key(cls, data: bytes, *_: Any, **__: Any) -> "Sample":
            return cls(b"")

    Sample.__idl__ = described.__idl__
    return Sample


@cache
def _struct(ros_type: str, has_header: bool) -> Any:
    """Return the IDL structure of a message type."""
    from cyclonedds.idl import make_idl_struct
    from cyclonedds.idl.types import int64, uint64

    fields: dict[str, Any] = {"guid_": uint64, "seq_": int64} if has_header else {}  # no field of ROS ends so
    fields |= {name: _idl(kind) for name, kind in fields_of(ros_type)[1]}
    return make_idl_struct(ros_type.rpartition("/")[2] + "_", dds_type(ros_type), fields)


def _idl(kind: tuple[Any, Any]) -> Any:
    """Return the IDL type of a field; ``kind`` is rosbags' (node type, details)."""
    from cyclonedds.idl import types as idl_types
    from rosbags.interfaces import Nodetype

    types: Any = idl_types  # its classes are indexed by metaclasses
    node, details = kind
    if node == Nodetype.NAME:
        return _struct(details, False)
    if node == Nodetype.BASE:
        name, bound = details
        if name == "wstring":
            raise ValueError("wstring is not a type of DDS in Python")
        if name == "string":
            return types.bounded_str[bound] if bound else str
        return {"bool": bool, "char": types.uint8, "byte": types.uint8}.get(name) or getattr(types, name)
    element, size = details
    if node == Nodetype.ARRAY:
        return types.array[_idl(element), size]
    return types.sequence[_idl(element), size] if size else types.sequence[_idl(element)]


def _gid(data: Iterable[int]) -> dict[str, list[int]]:
    return {"data": list(data)}
