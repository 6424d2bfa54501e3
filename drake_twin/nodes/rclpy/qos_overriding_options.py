"""Stand-in for ``rclpy.qos_overriding_options``: parameters that set the quality of service."""

import typing
from collections.abc import Callable, Iterable
from typing import Any

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy import qos_profiles as policies
from drake_twin.nodes.rclpy.duration import Duration
from drake_twin.nodes.rclpy.exceptions import ParameterAlreadyDeclaredException
from drake_twin.nodes.rclpy.qos_profiles import QoSPolicyEnum, QoSPolicyKind, QoSProfile

QoSProfileAttributes = typing.Union[  # noqa: UP007  # as rclpy has it
    policies.HistoryPolicy, int, policies.ReliabilityPolicy, policies.DurabilityPolicy, policies.LivelinessPolicy,
    Duration, bool,
]  # fmt: skip


def __getattr__(name: str) -> Any:
    if name == "QosCallbackResult":  # what a callback returns
        return message_class("rcl_interfaces/msg/SetParametersResult")
    if name == "QosCallbackType":
        return typing.Callable[[QoSProfile], __getattr__("QosCallbackResult")]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


class InvalidQosOverridesError(Exception):
    """Raised if the program refuses a profile that parameters have changed."""


class QoSOverridingOptions:
    """Which policies parameters may set.

    Args:
        policy_kinds: The policies.
        callback: Returns whether the resulting profile is valid, as a ``SetParametersResult``.
        entity_id: Tells several publishers or subscriptions of a topic apart.
    """

    def __init__(
        self,
        policy_kinds: Iterable[QoSPolicyKind],
        *,
        callback: Callable[[QoSProfile], Any] | None = None,
        entity_id: str | None = None,
    ):
        self._policy_kinds, self._callback, self._entity_id = policy_kinds, callback, entity_id

    policy_kinds = property(lambda self: self._policy_kinds)
    callback = property(lambda self: self._callback)
    entity_id = property(lambda self: self._entity_id)

    @classmethod
    def with_default_policies(
        cls, *, callback: Callable[[QoSProfile], Any] | None = None, entity_id: str | None = None
    ) -> "QoSOverridingOptions":
        kinds = QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH, QoSPolicyKind.RELIABILITY
        return cls(kinds, callback=callback, entity_id=entity_id)


def _declare_qos_parameters(
    entity_type: type, node: Any, topic: str, profile: QoSProfile, options: QoSOverridingOptions
) -> None:
    """Declare the parameters of a publisher or a subscription, and set its profile by them.

    Raises:
        InvalidQosOverridesError: If the program refuses the result.
        RuntimeError: If a parameter names no value of its policy.
    """
    what = entity_type.__name__.lower()
    suffix = "" if options.entity_id is None else f"_{options.entity_id}"
    for kind in options.policy_kinds:
        if kind is QoSPolicyKind.LIFESPAN and what == "subscription":
            continue
        policy = kind.name.lower()
        name = f"qos_overrides.{topic}.{what}{suffix}.{policy}"
        text = f"{policy} for {what} `{topic}` with id `{options.entity_id}`"
        descriptor = message_class("rcl_interfaces/msg/ParameterDescriptor")(description=text, read_only=True)
        known = getattr(profile, policy)
        try:
            value = node.declare_parameter(name, _get_qos_policy_parameter(profile, kind), descriptor).value
        except ParameterAlreadyDeclaredException:
            value = node.get_parameter(name).value
        setattr(profile, policy, _from_parameter(policy, known, value))
    if options.callback is not None:
        result = options.callback(profile)
        if not result.successful:
            raise InvalidQosOverridesError(
                f"Provided QoS overrides for {what} `{topic}` are not valid: {result.reason}"
            )


def _get_qos_policy_parameter(profile: QoSProfile, policy: QoSPolicyKind) -> Any:
    """Return the value of a policy as a parameter has it."""
    value = getattr(profile, policy.name.lower())
    if isinstance(value, QoSPolicyEnum):
        if value.name == "UNKNOWN":
            raise ValueError("User provided QoS profile is invalid")
        return value.short_key
    return value.nanoseconds if isinstance(value, Duration) else value


def _from_parameter(policy: str, known: Any, value: Any) -> Any:
    if isinstance(known, Duration):
        return Duration(nanoseconds=value)
    if not isinstance(known, QoSPolicyEnum):
        return value
    kind = getattr(policies, f"{policy.capitalize()}Policy")
    if value.upper() not in kind.__members__:
        raise RuntimeError(f"Unexpected QoS override for policy `{policy}`: `{value}`")
    return kind[value.upper()]
