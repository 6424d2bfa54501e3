"""The classes of messages, services and actions by their names, such as ``std_msgs/msg/String``."""

from collections.abc import Callable
from typing import Any

from drake_twin.nodes.rosidl_parser.definition import NamespacedType
from drake_twin.nodes.rosidl_runtime_py.import_message import import_message_from_namespaced_type


def get_interface(identifier: str) -> Any:
    """Return the class of a message, a service or an action; see `import_message_from_namespaced_type`."""
    return import_message_from_namespaced_type(get_namespaced_type(identifier))


def get_message(identifier: str) -> Any:
    """Return the class of a message, of which the name may lack ``msg``.

    Raises:
        ValueError: If the name is that of another interface.
    """
    return _of_kind(identifier, get_message_namespaced_type, is_message, "a message")


def get_service(identifier: str) -> Any:
    """Return the class of a service; see `get_message`."""
    return _of_kind(identifier, get_service_namespaced_type, is_service, "a service")


def get_action(identifier: str) -> Any:
    """Return the class of an action; see `get_message`."""
    return _of_kind(identifier, get_action_namespaced_type, is_action, "an action")


def get_namespaced_type(identifier: str) -> NamespacedType:
    """Return the type of a full name."""
    return _named(identifier)


def get_message_namespaced_type(identifier: str) -> NamespacedType:
    """Return the type of a message's name."""
    return _named(identifier, "msg")


def get_service_namespaced_type(identifier: str) -> NamespacedType:
    """Return the type of a service's name."""
    return _named(identifier, "srv")


def get_action_namespaced_type(identifier: str) -> NamespacedType:
    """Return the type of an action's name."""
    return _named(identifier, "action")


def is_message(interface: Any) -> bool:
    """Return whether something is a message, or the class of one."""
    return hasattr(interface, "get_fields_and_field_types")


def is_service(interface: Any) -> bool:
    """Return whether something is a service's class."""
    return hasattr(interface, "Request") and hasattr(interface, "Response")


def is_action(interface: Any) -> bool:
    """Return whether something is an action's class."""
    return all(hasattr(interface, part) for part in ("Goal", "Result", "Feedback"))


def _of_kind(identifier: str, named: Callable[[str], NamespacedType], is_kind: Callable[[Any], bool], what: str) -> Any:
    found = import_message_from_namespaced_type(named(identifier))
    if not is_kind(found):
        raise ValueError(f"Expected the full name of {what}, got '{identifier}'")
    return found


def _named(identifier: str, kind: str | None = None) -> NamespacedType:
    *namespaces, name = identifier.split("/")
    if len(namespaces) == 1 and kind is not None:
        namespaces.append(kind)
    return NamespacedType(namespaces, name)
