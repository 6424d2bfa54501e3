"""Stand-in for ``rclpy.topic_endpoint_info``."""

from enum import IntEnum
from typing import Any

from drake_twin.nodes.rclpy.qos_profiles import HistoryPolicy, QoSPresetProfiles, QoSProfile
from drake_twin.nodes.rclpy.type_hash import TypeHash


class TopicEndpointTypeEnum(IntEnum):
    """What an endpoint does."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


class _Field:
    """A field that takes values of a type; of another one that the type is made of, too."""

    def __init__(self, kind: type, made_of: type | None = None):
        self._kind, self._made_of = kind, made_of

    def __set_name__(self, owner: type, name: str) -> None:
        self._slot = f"_{name}"

    def __get__(self, info: Any, owner: type) -> Any:
        return self if info is None else getattr(info, self._slot)

    def __set__(self, info: Any, value: Any) -> None:
        if not isinstance(value, self._kind):
            if self._made_of is None or not isinstance(value, self._made_of):
                raise AssertionError
            value = self._kind(**value) if isinstance(value, dict) else self._kind(value)
        setattr(info, self._slot, value)


class TopicEndpointInfo:
    """A publisher or a subscription of a topic."""

    __slots__ = [  # noqa: RUF023  # in ROS's order
        "_node_name",
        "_node_namespace",
        "_topic_type",
        "_topic_type_hash",
        "_endpoint_type",
        "_endpoint_gid",
        "_qos_profile",
    ]
    __hash__ = None  # type: ignore[assignment]

    node_name: Any = _Field(str)
    node_namespace: Any = _Field(str)
    topic_type: Any = _Field(str)
    topic_type_hash: Any = _Field(TypeHash, dict)
    endpoint_type: Any = _Field(TopicEndpointTypeEnum, int)
    endpoint_gid: Any = _Field(list)
    qos_profile: Any = _Field(QoSProfile, dict)

    def __init__(self, **kwargs: Any):
        if not all(f"_{name}" in self.__slots__ for name in kwargs):
            raise AssertionError(f"Invalid arguments passed to constructor: {kwargs.keys()}")
        defaults: tuple[Any, ...] = (
            "",
            "",
            "",
            TypeHash(),
            TopicEndpointTypeEnum.INVALID,
            [],
            QoSPresetProfiles.UNKNOWN.value,
        )
        for slot, default in zip(self.__slots__, defaults, strict=True):
            setattr(self, slot[1:], kwargs.get(slot[1:], default))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TopicEndpointInfo):
            return False
        return all(getattr(self, slot) == getattr(other, slot) for slot in self.__slots__)

    def __str__(self) -> str:
        qos = self.qos_profile
        history = qos.history.name if qos.history != HistoryPolicy.KEEP_LAST else f"{qos.history.name} ({qos.depth})"
        return "\n".join(
            (
                f"Node name: {self.node_name}",
                f"Node namespace: {self.node_namespace}",
                f"Topic type: {self.topic_type}",
                f"Topic type hash: {self.topic_type_hash}",
                f"Endpoint type: {self.endpoint_type.name}",
                f"GID: {'.'.join(format(item, '02x') for item in self.endpoint_gid)}",
                "QoS profile:",
                f"  Reliability: {qos.reliability.name}",
                f"  History (Depth): {history}",
                f"  Durability: {qos.durability.name}",
                f"  Lifespan: {qos.lifespan}",
                f"  Deadline: {qos.deadline}",
                f"  Liveliness: {qos.liveliness.name}",
                f"  Liveliness lease duration: {qos.liveliness_lease_duration}",
            )
        )
