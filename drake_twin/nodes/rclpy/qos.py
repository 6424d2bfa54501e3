"""Stand-in for ``rclpy.qos``."""

from enum import Enum, IntEnum
from typing import Any

from drake_twin.nodes.rclpy.duration import Duration


class _ShortKeys(Enum):
    """What has short names."""

    @classmethod
    def short_keys(cls) -> list[str]:
        return [name.lower() for name in cls.__members__]

    @classmethod
    def get_from_short_key(cls, name: str) -> Any:
        return cls[name.upper()].value


class QoSPolicyEnum(_ShortKeys, IntEnum):
    """Values of a policy."""

    @property
    def short_key(self) -> str:
        return self.name.lower()


class HistoryPolicy(QoSPolicyEnum):
    SYSTEM_DEFAULT = 0
    RMW_QOS_POLICY_HISTORY_SYSTEM_DEFAULT = SYSTEM_DEFAULT
    KEEP_LAST = 1
    RMW_QOS_POLICY_HISTORY_KEEP_LAST = KEEP_LAST
    KEEP_ALL = 2
    RMW_QOS_POLICY_HISTORY_KEEP_ALL = KEEP_ALL
    UNKNOWN = 3


class ReliabilityPolicy(QoSPolicyEnum):
    SYSTEM_DEFAULT = 0
    RMW_QOS_POLICY_RELIABILITY_SYSTEM_DEFAULT = SYSTEM_DEFAULT
    RELIABLE = 1
    RMW_QOS_POLICY_RELIABILITY_RELIABLE = RELIABLE
    BEST_EFFORT = 2
    RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT = BEST_EFFORT
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class DurabilityPolicy(QoSPolicyEnum):
    SYSTEM_DEFAULT = 0
    RMW_QOS_POLICY_DURABILITY_SYSTEM_DEFAULT = SYSTEM_DEFAULT
    TRANSIENT_LOCAL = 1
    RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL = TRANSIENT_LOCAL
    VOLATILE = 2
    RMW_QOS_POLICY_DURABILITY_VOLATILE = VOLATILE
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class LivelinessPolicy(QoSPolicyEnum):
    SYSTEM_DEFAULT = 0
    RMW_QOS_POLICY_LIVELINESS_SYSTEM_DEFAULT = SYSTEM_DEFAULT
    AUTOMATIC = 1
    RMW_QOS_POLICY_LIVELINESS_AUTOMATIC = AUTOMATIC
    MANUAL_BY_TOPIC = 3
    RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC = MANUAL_BY_TOPIC
    UNKNOWN = 4
    BEST_AVAILABLE = 5


QoSHistoryPolicy, QoSReliabilityPolicy = HistoryPolicy, ReliabilityPolicy
QoSDurabilityPolicy, QoSLivelinessPolicy = DurabilityPolicy, LivelinessPolicy


class InvalidQoSProfileException(Exception):
    """Raised for settings that contradict each other."""

    def __init__(self, *args: Any) -> None:
        super().__init__("Invalid QoSProfile", *args)


class QoSProfile:
    """The settings of a publisher, a subscription, a client or a service."""

    def __init__(
        self,
        *,
        history: Any = None,
        depth: int | None = None,
        reliability: Any = ReliabilityPolicy.RELIABLE,
        durability: Any = DurabilityPolicy.VOLATILE,
        lifespan: Duration | None = None,
        deadline: Duration | None = None,
        liveliness: Any = LivelinessPolicy.SYSTEM_DEFAULT,
        liveliness_lease_duration: Duration | None = None,
        avoid_ros_namespace_conventions: bool = False,
    ):
        if history is None:
            if depth is None:
                raise InvalidQoSProfileException("History and/or depth settings are required.")
            history = HistoryPolicy.KEEP_LAST
        self.history = HistoryPolicy(history)
        if self.history is HistoryPolicy.KEEP_LAST and depth is None:
            raise InvalidQoSProfileException("History set to KEEP_LAST without a depth setting.")
        if depth is not None and (not isinstance(depth, int) or depth < 0):
            raise ValueError("depth must be an integer, zero or greater")
        self.depth = depth or 0
        self.reliability = ReliabilityPolicy(reliability)
        self.durability = DurabilityPolicy(durability)
        self.lifespan = lifespan or Duration()
        self.deadline = deadline or Duration()
        self.liveliness = LivelinessPolicy(liveliness)
        self.liveliness_lease_duration = liveliness_lease_duration or Duration()
        self.avoid_ros_namespace_conventions = avoid_ros_namespace_conventions

    def __eq__(self, other: object) -> bool:
        return isinstance(other, QoSProfile) and vars(self) == vars(other)

    def __hash__(self) -> int:
        return id(self)

    def __repr__(self) -> str:
        return f"QoSProfile({', '.join(f'{name}={value}' for name, value in vars(self).items())})"

    @property
    def queue_size(self) -> int | None:
        """The number of messages that wait; None for all."""
        return None if self.history is HistoryPolicy.KEEP_ALL else max(1, self.depth)


qos_profile_unknown = QoSProfile(history=HistoryPolicy.UNKNOWN, depth=0)
qos_profile_default = QoSProfile(depth=10)
qos_profile_system_default = QoSProfile(
    history=HistoryPolicy.SYSTEM_DEFAULT,
    reliability=ReliabilityPolicy.SYSTEM_DEFAULT,
    durability=DurabilityPolicy.SYSTEM_DEFAULT,
)
qos_profile_sensor_data = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
qos_profile_services_default = QoSProfile(depth=10)
qos_profile_parameters = QoSProfile(depth=1000)
qos_profile_parameter_events = QoSProfile(depth=1000)
qos_profile_best_available = QoSProfile(depth=10)
qos_profile_action_status_default = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
qos_profile_rosout_default = QoSProfile(
    depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL, lifespan=Duration(seconds=10)
)


class QoSPresetProfiles(_ShortKeys):
    """The profiles by name."""

    UNKNOWN = qos_profile_unknown
    DEFAULT = qos_profile_default
    SYSTEM_DEFAULT = qos_profile_system_default
    SENSOR_DATA = qos_profile_sensor_data
    SERVICES_DEFAULT = qos_profile_services_default
    PARAMETERS = qos_profile_parameters
    PARAMETER_EVENTS = qos_profile_parameter_events
    ACTION_STATUS_DEFAULT = qos_profile_action_status_default
    BEST_AVAILABLE = qos_profile_best_available


def as_seen(given: QoSProfile, *, is_publisher: bool) -> QoSProfile:
    """Return what others see of a profile on the graph: what a middleware makes of what is left open."""
    is_lossy, is_kept = ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.TRANSIENT_LOCAL
    keeps_all, is_manual = given.history is HistoryPolicy.KEEP_ALL, LivelinessPolicy.MANUAL_BY_TOPIC
    return QoSProfile(
        history=HistoryPolicy.KEEP_ALL if keeps_all else HistoryPolicy.KEEP_LAST,
        depth=0 if keeps_all else max(1, given.depth),
        reliability=is_lossy if given.reliability is is_lossy else ReliabilityPolicy.RELIABLE,
        durability=is_kept if given.durability is is_kept else DurabilityPolicy.VOLATILE,
        lifespan=_or_endless(given.lifespan if is_publisher else Duration()),
        deadline=_or_endless(given.deadline),
        liveliness=is_manual if given.liveliness is is_manual else LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=_or_endless(given.liveliness_lease_duration),
    )


def _or_endless(span: Duration) -> Duration:
    return span if span.nanoseconds else Duration(nanoseconds=2**63 - 1)


def profile_of(qos: Any) -> QoSProfile:
    """Return the profile of what publishers and subscriptions accept: a profile, a preset or a depth.

    Raises:
        TypeError: If it is something else.
    """
    if isinstance(qos, QoSProfile):
        return qos
    if isinstance(qos, QoSPresetProfiles):
        return qos.value
    if isinstance(qos, int) and not isinstance(qos, bool):
        if qos < 0:
            raise ValueError("history depth must be greater than or equal to zero")
        return QoSProfile(depth=qos)
    raise TypeError(f"Expected QoSProfile or int, but received {type(qos)!r}")
