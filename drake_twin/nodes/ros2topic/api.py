"""Topics of the graph, their classes, and profiles of quality of service by the command line's words."""

import time
from copy import copy
from typing import Any

from drake_twin.nodes.rclpy import ok
from drake_twin.nodes.rclpy.duration import Duration
from drake_twin.nodes.rclpy.exceptions import InvalidTopicNameException
from drake_twin.nodes.rclpy.expand_topic_name import expand_topic_name
from drake_twin.nodes.rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
)
from drake_twin.nodes.rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden
from drake_twin.nodes.rclpy.validate_full_topic_name import validate_full_topic_name
from drake_twin.nodes.rosidl_runtime_py.utilities import get_message


def get_topic_names_and_types(*, node: Any, include_hidden_topics: bool = False) -> list[tuple[str, list[str]]]:
    """Return the topics with their types; those of which a part begins with an underscore are hidden."""
    found = node.get_topic_names_and_types()
    return [each for each in found if include_hidden_topics or not topic_or_service_is_hidden(each[0])]


def get_topic_names(*, node: Any, include_hidden_topics: bool = False) -> list[str]:
    """Return the topics; see `get_topic_names_and_types`."""
    return [name for name, _ in get_topic_names_and_types(node=node, include_hidden_topics=include_hidden_topics)]


def get_msg_class(node: Any, topic: str, blocking: bool = False, include_hidden_topics: bool = False) -> Any:
    """Return the class of a topic's messages; None without one, or wait for it where `blocking`.

    Raises:
        RuntimeError: If the name is invalid, or the topic has several types.
    """
    found = _msg_class(node, topic, include_hidden_topics)
    if found is None:
        print(f"WARNING: topic [{topic}] does not appear to be published yet")
    while found is None and blocking and ok():
        time.sleep(0.1)
        found = _msg_class(node, topic, include_hidden_topics)
    return found


def profile_configure_short_keys(
    profile: QoSProfile,
    reliability: str | None = None,
    durability: str | None = None,
    depth: int | None = None,
    history: str | None = None,
    liveliness: str | None = None,
    liveliness_lease_duration_s: float | None = None,
) -> None:
    """Change a profile by words: ``best_effort``, ``transient_local``, ``keep_all``, …."""
    words = {
        "history": (HistoryPolicy, history),
        "durability": (DurabilityPolicy, durability),
        "reliability": (ReliabilityPolicy, reliability),
        "liveliness": (LivelinessPolicy, liveliness),
    }
    for name, (policy, word) in words.items():
        if word:
            setattr(profile, name, policy.get_from_short_key(word))
    if liveliness_lease_duration_s and liveliness_lease_duration_s >= 0:
        profile.liveliness_lease_duration = Duration(seconds=liveliness_lease_duration_s)
    if depth and depth >= 0:
        profile.depth = depth
    elif profile.durability == DurabilityPolicy.TRANSIENT_LOCAL and profile.depth == 0:
        profile.depth = 1


def qos_profile_from_short_keys(preset_profile: str, *arguments: Any, **options: Any) -> QoSProfile:
    """Return a profile by the name of a preset, changed as by `profile_configure_short_keys`."""
    profile: QoSProfile = copy(QoSPresetProfiles.get_from_short_key(preset_profile))
    profile_configure_short_keys(profile, *arguments, **options)
    return profile


def _msg_class(node: Any, topic: str, include_hidden_topics: bool) -> Any:
    try:
        name = expand_topic_name(topic, node.get_name(), node.get_namespace())
        validate_full_topic_name(name)
    except (ValueError, InvalidTopicNameException) as error:
        raise RuntimeError(error) from None
    known = dict(get_topic_names_and_types(node=node, include_hidden_topics=include_hidden_topics))
    types = known.get(name, [])
    if len(types) > 1:
        raise RuntimeError(f"Cannot echo topic '{topic}', as it contains more than one type: [{', '.join(types)}]")
    try:
        return get_message(types[0]) if types else None
    except ValueError:
        raise RuntimeError(f"The message type '{types[0]}' is invalid") from None
