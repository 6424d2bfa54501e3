"""The format of rmw_zenoh for ROS 2 Jazzy: key expressions, liveliness tokens and attachments.

Text and bytes only: nothing here opens a session. The upstream sources are ``liveliness_utils.cpp``,
``attachment_helpers.cpp`` and ``qos.cpp`` in ``rmw_zenoh_cpp/src/detail``.
"""

import struct

from drake_twin.dataclass import dataclass
from drake_twin.wires.ros_names import dds_type, ros_type

NO_HASH = "TypeHashNotSupported"  # what ROS 2 Humble writes, which has no type hashes
NODE, PUBLISHER, SUBSCRIPTION, SERVICE, CLIENT = "NN", "MP", "MS", "SS", "SC"
_DEPTH = 42  # RMW_ZENOH_DEFAULT_HISTORY_DEPTH of qos.hpp
_ATTACHMENT = struct.Struct("<qqB16s")


@dataclass(frozen=True)
class Qos:
    """The quality of service that a token announces.

    Attributes:
        transient_local: Whether a late joiner gets the last messages.
        depth: How many messages are kept; 0 for all.
        is_reliable: Whether messages are sent until they are received.
        deadline: The longest time between messages (ns); None for any.
        lifespan: The time after which a message is not delivered any more (ns); None for never.
        is_manual: Whether the publisher says itself that it is alive.
        lease: The time in which it has to (ns); None for any.
    """

    transient_local: bool = False
    depth: int = 10
    is_reliable: bool = True
    deadline: int | None = None
    lifespan: int | None = None
    is_manual: bool = False
    lease: int | None = None

    def __str__(self) -> str:
        # Reliable is 1, best effort 2; transient local 1, volatile 2; keep last 1, all 2; automatic is the default and
        # manual 3 (rmw/types.h). They are written out: an empty field is rmw_zenoh's own default, which is not the same
        # in all of its versions.
        deadline, lifespan, lease = map(_seconds, (self.deadline, self.lifespan, self.lease))
        first = f"{1 if self.is_reliable else 2}:{1 if self.transient_local else 2}"
        history = f"1,{self.depth}" if self.depth else "2,"
        return f"{first}:{history}:{deadline}:{lifespan}:{3 if self.is_manual else ''},{lease}"

    @classmethod
    def of(cls, text: str) -> "Qos":
        """Return what a token announces; an empty field is rmw_zenoh's default: reliable, volatile, the last 42."""
        reliability, durability, history, deadline, lifespan, alive = (text.split(":") + [""] * 6)[:6]
        keep, _, depth = history.partition(",")
        liveliness, _, lease = alive.partition(",")
        return cls(
            durability == "1",
            0 if keep == "2" else int(depth or _DEPTH),
            reliability != "2",
            _nanoseconds(deadline),
            _nanoseconds(lifespan),
            liveliness == "3",
            _nanoseconds(lease),
        )


@dataclass(frozen=True)
class Node:
    """A node on the graph.

    Attributes:
        domain: The ROS domain.
        session: The id of the Zenoh session.
        number: The node's number within the session.
        name: Its name.
        namespace: Its namespace with a leading slash; ``/`` for none.
    """

    domain: int
    session: str
    number: int
    name: str
    namespace: str = "/"

    def token(self) -> str:
        """Return the key expression of the node's liveliness token."""
        return self._token(self.number, NODE)

    def endpoint_token(self, number: int, kind: str, topic: str, ros_type: str, type_hash: str, qos: Qos) -> str:
        """Return the key expression of an endpoint's liveliness token.

        Args:
            number: The endpoint's number within the session.
            kind: `PUBLISHER`, `SUBSCRIPTION`, `SERVICE` or `CLIENT`.
            topic: The topic's or service's name with a leading slash.
            ros_type: Its type, for example ``std_msgs/msg/String``.
            type_hash: ``RIHS01_…``, or `NO_HASH`.
            qos: Its quality of service.
        """
        return "/".join((self._token(number, kind), _mangled(topic), dds_type(ros_type), type_hash, str(qos)))

    def _token(self, number: int, kind: str) -> str:
        numbers = f"{self.domain}/{self.session}/{self.number}/{number}"
        return f"@ros2_lv/{numbers}/{kind}/%/{_mangled(self.namespace)}/{_mangled(self.name)}"


@dataclass(frozen=True)
class GraphEntity:
    """A node or an endpoint on the graph, as its liveliness token describes it.

    Attributes:
        kind: `NODE`, `PUBLISHER`, `SUBSCRIPTION`, `SERVICE` or `CLIENT`.
        node: The full name of its node.
        name: The full name of its topic or service; empty for a node.
        type: Its ROS type; empty for a node.
        hash: The type's hash; empty for a node.
        qos: Its quality of service.
        gid: The 16 bytes that identify it; empty for a node.
    """

    kind: str
    node: str
    name: str = ""
    type: str = ""
    hash: str = ""
    qos: Qos = Qos()
    gid: bytes = b""

    @property
    def latched(self) -> bool:
        """Whether late joiners get the last messages."""
        return self.qos.transient_local


def read_token(token: str) -> GraphEntity | None:
    """Return what a liveliness token describes; None for one of another format."""
    _, *parts = token.split("/")
    if len(parts) < 8 or parts[4] not in (NODE, PUBLISHER, SUBSCRIPTION, SERVICE, CLIENT):
        return None
    kind, namespace, node = parts[4], parts[6].replace("%", "/").rstrip("/"), parts[7]
    full = f"{namespace}/{node}"
    if kind == NODE:
        return GraphEntity(kind, full)
    if len(parts) != 12:
        return None
    name, dds, type_hash, qos = parts[8:]
    try:
        announced = Qos.of(qos)
    except ValueError:  # no number where one has to be
        return None
    return GraphEntity(kind, full, name.replace("%", "/"), ros_type(dds), type_hash, announced, gid(token))


def session_of(token: str) -> str:
    """Return the id of the Zenoh session that a liveliness token is of."""
    return token.split("/")[2]


def graph_key(domain: int | str) -> str:
    """Return the key expression of all liveliness tokens of a domain; of all domains with ``*``."""
    return f"@ros2_lv/{domain}/**"


def servers_key(domain: int, service: str, ros_type: str) -> str:
    """Return the key expression of the liveliness tokens of a service's servers."""
    return f"@ros2_lv/{domain}/*/*/*/{SERVICE}/*/*/*/{_mangled(service)}/{dds_type(ros_type)}/*/*"


def topic_key(domain: int, topic: str, ros_type: str, type_hash: str) -> str:
    """Return the key expression of a topic's messages or of a service's requests."""
    return f"{domain}/{topic.strip('/')}/{dds_type(ros_type)}/{type_hash}"


def any_type_key(domain: int, topic: str) -> str:
    """Return the key expression of a topic's messages, whatever their type and hash."""
    return f"{domain}/{topic.strip('/')}/*/*"


def gid(token: str) -> bytes:
    """Return the 16 bytes that identify an endpoint: the XXH3 of its token, the lower half first."""
    import xxhash

    return xxhash.xxh3_128_digest(token.encode())[::-1]  # xxhash's digest is big-endian


def attachment(sequence: int, time: int, source: bytes) -> bytes:
    """Return what accompanies a message.

    Args:
        sequence: The message's number, from 1 on; of a reply, the request's number.
        time: When it was sent (ns).
        source: The sender's `gid`; of a reply, the client's.
    """
    return _ATTACHMENT.pack(sequence, time, 16, source)


def read_attachment(data: bytes) -> tuple[int, int, bytes]:
    """Return sequence number, time (ns) and gid.

    Raises:
        ValueError: If the bytes are not an attachment of Jazzy's rmw_zenoh.
    """
    if len(data) != _ATTACHMENT.size or data[16] != 16:
        raise ValueError(f"an attachment of {len(data)} bytes, but rmw_zenoh's has {_ATTACHMENT.size}")
    sequence, time, _, source = _ATTACHMENT.unpack(data)
    return sequence, time, source


def _nanoseconds(text: str) -> int | None:
    """Return a time of a token, ``seconds,nanoseconds``; None for an infinite one."""
    seconds, _, rest = text.partition(",")
    return int(seconds or 0) * 10**9 + int(rest or 0) if seconds or rest else None


def _seconds(time: int | None) -> str:
    """Return a time as a token has it; an infinite one is empty."""
    return "," if time is None else ",".join(map(str, divmod(time, 10**9)))


def _mangled(name: str) -> str:
    return name.replace("/", "%")
