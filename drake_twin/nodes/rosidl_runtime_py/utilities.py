"""The classes of messages, services and actions by their names, such as ``std_msgs/msg/String``."""

from importlib import import_module
from typing import Any


def get_interface(identifier: str) -> Any:
    """Return the class of a message, a service or an action.

    Raises:
        ValueError: If the name has not three parts, or the type is unknown.
    """
    parts = identifier.split("/")
    if len(parts) != 3 or not all(parts):
        raise ValueError(f"Invalid name '{identifier}'. Expected three parts separated by '/'")
    try:
        return getattr(import_module(f"{parts[0]}.{parts[1]}"), parts[2])
    except (ImportError, AttributeError) as error:
        raise ValueError(f"The type '{identifier}' is invalid: {error}") from None


def get_message(identifier: str) -> Any:
    """Return the class of a message; see `get_interface`."""
    return _of_kind(identifier, "msg", "message")


def get_service(identifier: str) -> Any:
    """Return the class of a service; see `get_interface`."""
    return _of_kind(identifier, "srv", "service")


def get_action(identifier: str) -> Any:
    """Return the class of an action; see `get_interface`."""
    return _of_kind(identifier, "action", "action")


def _of_kind(identifier: str, kind: str, what: str) -> Any:
    parts = identifier.split("/")
    if len(parts) == 3 and parts[1] != kind:
        raise ValueError(f"Expected the full name of a {what}, got '{identifier}'")
    return get_interface(identifier)


def is_message(interface: Any) -> bool:
    """Return whether something is a message, or the class of one."""
    return hasattr(interface, "get_fields_and_field_types")


def is_service(interface: Any) -> bool:
    """Return whether something is a service's class."""
    return hasattr(interface, "Request") and hasattr(interface, "Response")


def is_action(interface: Any) -> bool:
    """Return whether something is an action's class."""
    return hasattr(interface, "Goal") and hasattr(interface, "Feedback")
