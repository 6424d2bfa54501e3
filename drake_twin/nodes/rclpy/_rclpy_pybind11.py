"""Stand-in for ``rclpy._rclpy_pybind11``: the exceptions of rclpy's C++, its entities for waitables, and the
policies that it names.
"""

import builtins
from enum import IntEnum
from importlib import import_module
from typing import Any

_ENTITIES = ("Client", "GuardCondition", "Service", "Subscription", "Timer")


def __getattr__(name: str) -> Any:
    if name in _ENTITIES:  # imported late, since they need this module
        return getattr(import_module("drake_twin.nodes.rclpy.native_entities"), name)
    if name == "rmw_qos_profile_t":
        return import_module("drake_twin.nodes.rclpy.qos_profiles").rmw_qos_profile_t
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


class RCLError(RuntimeError):
    """Raised for what rcl refuses."""


class RCLInvalidROSArgsError(RCLError):
    """Raised for rules after ``--ros-args`` that rcl cannot parse."""


class NodeNameNonExistentError(RCLError):
    """Raised for a node that is not on the graph."""


class UnsupportedEventTypeError(RCLError):
    """Raised for an event that the middleware does not have."""


class UnknownROSArgsError(RuntimeError):
    """Raised for words after ``--ros-args`` that rcl does not know."""


class InvalidHandle(RuntimeError):
    """Raised for something that has been destroyed."""


class RCUtilsError(RuntimeError):
    """Raised for what rcutils refuses."""


class RMWError(RuntimeError):
    """Raised for what the middleware refuses."""


class NotImplementedError(builtins.NotImplementedError):
    """Raised for what the middleware does not have."""


class rmw_qos_policy_kind_t(IntEnum):  # noqa: N801  # its name in rclpy
    """The policies, as events name them."""

    RMW_QOS_POLICY_INVALID = 1
    RMW_QOS_POLICY_DURABILITY = 2
    RMW_QOS_POLICY_DEADLINE = 4
    RMW_QOS_POLICY_LIVELINESS = 8
    RMW_QOS_POLICY_RELIABILITY = 16
    RMW_QOS_POLICY_HISTORY = 32
    RMW_QOS_POLICY_LIFESPAN = 64
    RMW_QOS_POLICY_DEPTH = 128
    RMW_QOS_POLICY_LIVELINESS_LEASE_DURATION = 256
    RMW_QOS_POLICY_AVOID_ROS_NAMESPACE_CONVENTIONS = 512

    def __str__(self) -> str:
        return f"rmw_qos_policy_kind_t.{self.name}"

    def __format__(self, spec: str) -> str:
        return format(str(self), spec)
