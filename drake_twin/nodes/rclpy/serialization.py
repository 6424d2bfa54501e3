"""Stand-in for ``rclpy.serialization``."""

from typing import Any

from drake_twin.messages.interface_types import deserialize, serialize
from drake_twin.nodes import interfaces


def serialize_message(message: Any) -> bytes:
    """Return a message's CDR bytes."""
    return serialize(interfaces.to_wire(message))


def deserialize_message(serialized_message: bytes, message_type: Any) -> Any:
    """Return the message of CDR bytes."""
    name = interfaces.type_name(message_type)
    return interfaces.from_wire(name, deserialize(name, bytes(serialized_message)))
