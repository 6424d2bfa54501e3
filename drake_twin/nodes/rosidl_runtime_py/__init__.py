"""Interfaces by their names (``rosidl_runtime_py.utilities``), messages from and as dictionaries."""

from drake_twin.nodes.rosidl_runtime_py.convert import message_to_csv, message_to_ordereddict, message_to_yaml
from drake_twin.nodes.rosidl_runtime_py.set_message import set_message_fields

__all__ = ["message_to_csv", "message_to_ordereddict", "message_to_yaml", "set_message_fields"]
