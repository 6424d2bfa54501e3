"""The qualities of service: policies and profiles of ``rclpy.qos``."""

import warnings
from collections.abc import Callable
from enum import Enum, IntEnum
from typing import Any, TypeVar

from drake_twin.nodes.rclpy.duration import Duration

_Policy = TypeVar("_Policy", bound=Enum)


class QoSPolicyKind(IntEnum):
    """The policies, as events name them."""

    INVALID = 1
    DURABILITY = 2
    DEADLINE = 4
    LIVELINESS = 8
    RELIABILITY = 16
    HISTORY = 32
    LIFESPAN = 64
    DEPTH = 128
    LIVELINESS_LEASE_DURATION = 256
    AVOID_ROS_NAMESPACE_CONVENTIONS = 512


def qos_policy_name_from_kind(policy_kind: QoSPolicyKind | int) -> str:
    return QoSPolicyKind(policy_kind).name


class _ShortKeys(Enum):
    """What has short names."""

    @classmethod
    def short_keys(cls) -> list[str]:
        return [name.lower() for name in cls.__members__ if not name.startswith("RMW")]

    @classmethod
    def get_from_short_key(cls, name: str) -> Any:
        return cls[name.upper()].value


class QoSPolicyEnum(_ShortKeys, IntEnum):
    """Values of a policy."""

    @property
    def short_key(self) -> str:
        return self.name.lower()


class _OldName:
    """A value under its name before Foxy."""

    def __init__(self, name: str):
        self._name = name

    def __get__(self, _: Any, owner: Any) -> Any:
        return owner[self._name]


def _with_old_names(policy: str) -> Callable[[type[_Policy]], type[_Policy]]:
    def decorate(cls: type[_Policy]) -> type[_Policy]:
        for name in cls.__members__:
            if name != "BEST_AVAILABLE":
                setattr(cls, f"RMW_QOS_POLICY_{policy}_{name}", _OldName(name))
        return cls

    return decorate


@_with_old_names("HISTORY")
class HistoryPolicy(QoSPolicyEnum):
    SYSTEM_DEFAULT = 0
    KEEP_LAST = 1
    KEEP_ALL = 2
    UNKNOWN = 3


@_with_old_names("RELIABILITY")
class ReliabilityPolicy(QoSPolicyEnum):
    SYSTEM_DEFAULT = 0
    RELIABLE = 1
    BEST_EFFORT = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


@_with_old_names("DURABILITY")
class DurabilityPolicy(QoSPolicyEnum):
    SYSTEM_DEFAULT = 0
    TRANSIENT_LOCAL = 1
    VOLATILE = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


@_with_old_names("LIVELINESS")
class LivelinessPolicy(QoSPolicyEnum):
    SYSTEM_DEFAULT = 0
    AUTOMATIC = 1
    MANUAL_BY_TOPIC = 3
    UNKNOWN = 4
    BEST_AVAILABLE = 5


QoSHistoryPolicy, QoSReliabilityPolicy = HistoryPolicy, ReliabilityPolicy
QoSDurabilityPolicy, QoSLivelinessPolicy = DurabilityPolicy, LivelinessPolicy


class InvalidQoSProfileException(Exception):
    """Raised for settings that contradict each other."""

    def __init__(self, *args: Any) -> None:
        super().__init__("Invalid QoSProfile", *args)


class _Setting:
    """A field of a profile, which takes values of some types only; those of an enumeration by number, too."""

    def __init__(self, *types: type):
        self._types = types
        self._enum: Any = types[0] if issubclass(types[0], QoSPolicyEnum) else None

    def __set_name__(self, owner: type, name: str) -> None:
        self._slot = f"_{name}"

    def __get__(self, profile: Any, owner: type) -> Any:
        return self if profile is None else getattr(profile, self._slot)

    def __set__(self, profile: Any, value: Any) -> None:
        if not isinstance(value, self._types):
            raise AssertionError
        setattr(profile, self._slot, value if self._enum is None else self._enum(value))


class QoSProfile:
    """The settings of a publisher, a subscription, a client or a service."""

    __slots__ = [  # noqa: RUF023  # in ROS's order
        "_history",
        "_depth",
        "_reliability",
        "_durability",
        "_lifespan",
        "_deadline",
        "_liveliness",
        "_liveliness_lease_duration",
        "_avoid_ros_namespace_conventions",
    ]
    __hash__ = None  # type: ignore[assignment]

    history: Any = _Setting(HistoryPolicy, int)
    depth: Any = _Setting(int)
    reliability: Any = _Setting(ReliabilityPolicy, int)
    durability: Any = _Setting(DurabilityPolicy, int)
    lifespan: Any = _Setting(Duration)
    deadline: Any = _Setting(Duration)
    liveliness: Any = _Setting(LivelinessPolicy, int)
    liveliness_lease_duration: Any = _Setting(Duration)
    avoid_ros_namespace_conventions: Any = _Setting(bool)

    def __init__(self, **kwargs: Any):
        if not all(f"_{name}" in self.__slots__ for name in kwargs):
            raise AssertionError(f"Invalid arguments passed to constructor: {kwargs.keys()}")
        if "history" not in kwargs and "depth" not in kwargs:
            raise InvalidQoSProfileException("History and/or depth settings are required.")
        self.history = kwargs.get("history", HistoryPolicy.KEEP_LAST)
        if self.history == HistoryPolicy.KEEP_LAST and "depth" not in kwargs:
            raise InvalidQoSProfileException("History set to KEEP_LAST without a depth setting.")
        for name, default in _DEFAULTS.items():
            setattr(self, name, kwargs.get(name, default))

    def __setattr__(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)
        if name == "depth" and value == 0 and self.history == HistoryPolicy.KEEP_LAST:
            text = "A zero depth with KEEP_LAST doesn't make sense; no data could be stored."
            warnings.warn(f"{text} This will be interpreted as SYSTEM_DEFAULT", stacklevel=2)

    def get_c_qos_profile(self) -> "rmw_qos_profile_t":
        return rmw_qos_profile_t(self)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, QoSProfile):
            return False
        return all(getattr(self, slot) == getattr(other, slot) for slot in self.__slots__)

    def __str__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{slot[1:]}={getattr(self, slot)}' for slot in self.__slots__)})"


_DEFAULTS = {
    "depth": 10,
    "reliability": ReliabilityPolicy.RELIABLE,
    "durability": DurabilityPolicy.VOLATILE,
    "lifespan": Duration(),
    "deadline": Duration(),
    "liveliness": LivelinessPolicy.SYSTEM_DEFAULT,
    "liveliness_lease_duration": Duration(),
    "avoid_ros_namespace_conventions": False,
}


class rmw_qos_profile_t:  # noqa: N801
    """What stands for rmw's structure."""

    def __init__(self, profile: QoSProfile):
        self.profile = profile

    def to_dict(self) -> dict[str, Any]:
        return {slot[1:]: getattr(self.profile, slot) for slot in QoSProfile.__slots__}

    @staticmethod
    def predefined(qos_profile_name: str) -> "rmw_qos_profile_t":
        found = globals().get(qos_profile_name)
        if not isinstance(found, QoSProfile):
            raise ValueError(f"Requested unknown rmw_qos_profile: {qos_profile_name}")
        return rmw_qos_profile_t(found)


def queue_size(profile: QoSProfile) -> int | None:
    """Return the number of messages that wait; None for all."""
    return None if profile.history is HistoryPolicy.KEEP_ALL else max(1, profile.depth)


DeadlineBestAvailable = LivelinessLeaseDurationeBestAvailable = Duration(nanoseconds=2**63 - 2)

qos_profile_unknown = QoSProfile(
    history=HistoryPolicy.UNKNOWN,
    depth=0,
    reliability=ReliabilityPolicy.UNKNOWN,
    durability=DurabilityPolicy.UNKNOWN,
    liveliness=LivelinessPolicy.UNKNOWN,
)
qos_profile_default = QoSProfile(depth=10)
qos_profile_system_default = QoSProfile(
    history=HistoryPolicy.SYSTEM_DEFAULT,
    depth=0,
    reliability=ReliabilityPolicy.SYSTEM_DEFAULT,
    durability=DurabilityPolicy.SYSTEM_DEFAULT,
)
qos_profile_sensor_data = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
qos_profile_services_default = QoSProfile(depth=10)
qos_profile_parameters = QoSProfile(depth=1000)
qos_profile_parameter_events = QoSProfile(depth=1000)
qos_profile_best_available = QoSProfile(
    depth=10,
    reliability=ReliabilityPolicy.BEST_AVAILABLE,
    durability=DurabilityPolicy.BEST_AVAILABLE,
    deadline=DeadlineBestAvailable,
    liveliness=LivelinessPolicy.BEST_AVAILABLE,
    liveliness_lease_duration=LivelinessLeaseDurationeBestAvailable,
)
qos_profile_action_status_default = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


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


def profile_of(qos: Any) -> QoSProfile:
    """Return the profile of what publishers and subscriptions accept: a profile or a depth.

    Raises:
        TypeError: If it is something else.
        ValueError: If the depth is negative.
    """
    if isinstance(qos, QoSProfile):
        return qos
    if isinstance(qos, int):
        if qos < 0:
            raise ValueError("history depth must be greater than or equal to zero")
        return QoSProfile(depth=qos)
    raise TypeError(f"Expected QoSProfile or int, but received {type(qos)!r}")
