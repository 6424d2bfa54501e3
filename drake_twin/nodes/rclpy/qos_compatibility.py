"""Which publishers and subscriptions hear each other, as DDS decides.

Source: ros2/rmw_dds_common (jazzy), rmw_dds_common/src/qos.cpp; eclipse-cyclonedds, ddsi_qosmatch.c.
"""

from typing import Any

from drake_twin.nodes.rclpy._rclpy_pybind11 import rmw_qos_policy_kind_t as rmw_qos_policy_kind_t
from drake_twin.nodes.rclpy.duration import Duration
from drake_twin.nodes.rclpy.native import native_enum
from drake_twin.nodes.rclpy.qos_profiles import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPolicyKind,
    QoSProfile,
    ReliabilityPolicy,
)
from drake_twin.twin.endpoints import Endpoint

_ENDLESS = 2**63 - 1
_LOSSY, _KEPT, _MANUAL = (
    ReliabilityPolicy.BEST_EFFORT,
    DurabilityPolicy.TRANSIENT_LOCAL,
    LivelinessPolicy.MANUAL_BY_TOPIC,
)


def profile_of(item: Endpoint) -> QoSProfile:
    """Return the quality of service of a topic of the twin."""
    return QoSProfile(
        depth=item.depth or (1 if item.latched else 10),
        reliability=_LOSSY if item.is_best_effort else ReliabilityPolicy.RELIABLE,
        durability=_KEPT if item.latched else DurabilityPolicy.VOLATILE,
        lifespan=Duration() if item.lifespan is None else Duration(seconds=item.lifespan),
    )


def as_seen(given: QoSProfile, *, is_publisher: bool) -> QoSProfile:
    """Return what others see of a profile on the graph: what a middleware makes of what is left open."""
    keeps_all = given.history is HistoryPolicy.KEEP_ALL
    return QoSProfile(
        history=HistoryPolicy.KEEP_ALL if keeps_all else HistoryPolicy.KEEP_LAST,
        depth=0 if keeps_all else max(1, given.depth),
        reliability=_LOSSY if given.reliability is _LOSSY else ReliabilityPolicy.RELIABLE,
        durability=_KEPT if given.durability is _KEPT else DurabilityPolicy.VOLATILE,
        lifespan=Duration(nanoseconds=_span(given.lifespan) if is_publisher else _ENDLESS),
        deadline=Duration(nanoseconds=_span(given.deadline)),
        liveliness=_MANUAL if given.liveliness is _MANUAL else LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=Duration(nanoseconds=_span(given.liveliness_lease_duration)),
    )


def mismatch(publisher: QoSProfile, subscription: QoSProfile) -> QoSPolicyKind | None:
    """Return the first policy of which a subscription requests more than a publisher offers; None if they match.

    What is best available takes what the other one has.
    """
    if publisher.reliability is _LOSSY and subscription.reliability not in (_LOSSY, ReliabilityPolicy.BEST_AVAILABLE):
        return QoSPolicyKind.RELIABILITY
    is_kept = publisher.durability in (_KEPT, DurabilityPolicy.BEST_AVAILABLE)
    if subscription.durability is _KEPT and not is_kept:
        return QoSPolicyKind.DURABILITY
    if _span(subscription.deadline) < _span(publisher.deadline):
        return QoSPolicyKind.DEADLINE
    is_manual = publisher.liveliness in (_MANUAL, LivelinessPolicy.BEST_AVAILABLE)
    if subscription.liveliness is _MANUAL and not is_manual:
        return QoSPolicyKind.LIVELINESS
    if _span(subscription.liveliness_lease_duration) < _span(publisher.liveliness_lease_duration):
        return QoSPolicyKind.LIVELINESS
    return None


def is_manual(profile: QoSProfile) -> bool:
    """Return whether a publisher says that it is alive by its messages only."""
    return profile.liveliness is _MANUAL


def _span(given: Duration) -> int:
    """Return a span in ns; one that is not given, or best available, is endless."""
    return given.nanoseconds if 0 < given.nanoseconds < _ENDLESS - 1 else _ENDLESS


def check(publisher: QoSProfile, subscription: QoSProfile) -> tuple[list[str], list[str]]:
    """Return what does not fit for certain, and what may not as it is left open, as rmw words it."""
    errors, open_ends = [], []
    open_reliability = ReliabilityPolicy.SYSTEM_DEFAULT, ReliabilityPolicy.UNKNOWN
    open_durability = DurabilityPolicy.SYSTEM_DEFAULT, DurabilityPolicy.UNKNOWN
    open_liveliness = LivelinessPolicy.SYSTEM_DEFAULT, LivelinessPolicy.UNKNOWN
    if publisher.reliability is _LOSSY and subscription.reliability is ReliabilityPolicy.RELIABLE:
        errors.append("Best effort publisher and reliable subscription")
    if publisher.durability is DurabilityPolicy.VOLATILE and subscription.durability is _KEPT:
        errors.append("Volatile publisher and transient local subscription")
    offered, requested = _span(publisher.deadline), _span(subscription.deadline)
    if requested < offered:
        is_open = offered == _ENDLESS
        errors.append(
            "Subscription has a deadline, but publisher does not"
            if is_open
            else "Subscription deadline is less than publisher deadline"
        )
    if publisher.liveliness is LivelinessPolicy.AUTOMATIC and subscription.liveliness is _MANUAL:
        errors.append("Publisher's liveliness is automatic and subscription's is manual by topic")
    offered, requested = _span(publisher.liveliness_lease_duration), _span(subscription.liveliness_lease_duration)
    if requested < offered:
        text = "Subscription has a liveliness lease duration, but publisher does not"
        errors.append(text if offered == _ENDLESS else "Subscription liveliness lease duration is less than publisher")
    pairs: tuple[tuple[str, Any, Any, Any, Any], ...] = (
        ("reliability", publisher.reliability, subscription.reliability, open_reliability, ReliabilityPolicy.RELIABLE),
        ("durability", publisher.durability, subscription.durability, open_durability, _KEPT),
        ("liveliness", publisher.liveliness, subscription.liveliness, open_liveliness, _MANUAL),
    )
    for name, one, other, left_open, strict in pairs:
        if one in left_open and other in left_open:
            open_ends.append(f"Publisher {name} is {one.short_key} and subscription {name} is {other.short_key}")
        elif one in left_open and other is strict:
            word = strict.short_key.replace("_", " ").capitalize()
            open_ends.append(f"{word} subscription, but publisher is {one.short_key}")
        elif other in left_open and one in _WEAK:
            word = one.short_key.replace("_", " ").capitalize()
            open_ends.append(f"{word} publisher, but subscription is {other.short_key}")
    return errors, open_ends


_WEAK = (_LOSSY, DurabilityPolicy.VOLATILE, LivelinessPolicy.AUTOMATIC)


QoSCompatibility = native_enum(
    "QoSCompatibility", "Whether a publisher's and a subscription's settings fit.", __name__, OK=0, WARNING=1, ERROR=2
)


def qos_check_compatible(publisher_qos: QoSProfile, subscription_qos: QoSProfile) -> tuple[Any, str]:
    errors, warned = check(publisher_qos, subscription_qos)
    kind = QoSCompatibility.ERROR if errors else QoSCompatibility.WARNING if warned else QoSCompatibility.OK
    return kind, "".join([f"ERROR: {text};" for text in errors] or [f"WARNING: {text};" for text in warned])
