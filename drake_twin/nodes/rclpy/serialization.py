"""Stand-in for ``rclpy.serialization``."""

from typing import Any

from drake_twin.messages.interface_types import deserialize, serialize
from drake_twin.nodes import message_classes


def serialize_message(message: Any) -> bytes:
    """Return a message's CDR bytes."""
    return serialize(message_classes.to_wire(message))


def deserialize_message(serialized_message: bytes, message_type: Any) -> Any:
    """Return the message of CDR bytes."""
    name = message_classes.type_name(message_type)
    return message_classes.from_wire(name, deserialize(name, bytes(serialized_message)))
