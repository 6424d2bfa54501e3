"""Stand-in for ``rclpy.type_support``: what is checked of a message's, a service's or an action's class."""

from typing import Any

from drake_twin.nodes.rclpy.exceptions import NoTypeSupportImportedException


def check_for_type_support(msg_or_srv_type: Any) -> None:
    """Check that a class is an interface's.

    Raises:
        AttributeError: If it is not.
        NoTypeSupportImportedException: If it has no type support, also after that was imported.
    """
    if not hasattr(msg_or_srv_type, "__ros_type__") and not hasattr(msg_or_srv_type, "_TYPE_SUPPORT"):
        name = type(msg_or_srv_type).__name__
        text = f"type object '{name}' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 message type"
        raise AttributeError(f"{text} but it should be a ROS 2 message type.")
    if getattr(msg_or_srv_type, "_TYPE_SUPPORT", True) is None:
        msg_or_srv_type.__import_type_support__()
        if msg_or_srv_type._TYPE_SUPPORT is None:
            raise NoTypeSupportImportedException


def check_is_valid_msg_type(msg_type: Any) -> None:
    _check(msg_type, "message", ("get_fields_and_field_types",), "service or action")


def check_is_valid_srv_type(srv_type: Any) -> None:
    _check(srv_type, "service", ("Request", "Response"), "message or action")


def check_is_valid_action_type(action_type: Any) -> None:
    """Check that a class is an action's."""
    _check(action_type, "action", ("Goal", "Result", "Feedback"), "message or service")


def _check(given: Any, kind: str, parts: tuple[str, ...], others: str) -> None:
    check_for_type_support(given)
    if not all(hasattr(given, name) for name in parts):
        raise RuntimeError(f"The {kind} type provided is not valid ({given}), this might be a {others}")


__all__ = [
    "NoTypeSupportImportedException",
    "check_for_type_support",
    "check_is_valid_action_type",
    "check_is_valid_msg_type",
    "check_is_valid_srv_type",
]
