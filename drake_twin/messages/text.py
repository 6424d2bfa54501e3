"""Messages as ROS 2's command line tools print them."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import yaml

LONGEST = 128  # as `ros2 topic echo` cuts sequences and texts


def message_text(message: object, longest: int | None = LONGEST, *, flow_style: bool = False) -> str:
    """Return a message as ``ros2 topic echo`` prints it.

    Args:
        message: The message.
        longest: The length at which sequences and texts are cut; None cuts none.
        flow_style: Whether it is printed on one line.
    """
    plain = plain_data(message, longest)
    text: str = yaml.safe_dump(plain, sort_keys=False, allow_unicode=True, width=10_000, default_flow_style=flow_style)
    return f"{text}---"


def call_text(message: Any) -> str:
    """Return a message as Python prints it in ROS 2, for example ``std_msgs.msg.String(data='hello')``."""
    if is_dataclass(message) and not isinstance(message, type):
        name = str(getattr(message, "__msgtype__", "")).replace("/", ".")
        own = (f"{item}={call_text(getattr(message, item))}" for item in field_names(message))
        return f"{name}({', '.join(own)})"
    if hasattr(message, "tolist"):
        return repr(message.tolist())
    if isinstance(message, list | tuple):
        return f"[{', '.join(map(call_text, message))}]"
    return repr(message)


def field_names(message: Any) -> list[str]:
    """Return the names of a message's fields; those of rosbags' classes are constants and the message's type, too.

    ROS spells fields in lower case and constants in upper case.
    """
    names = (item.name for item in fields(message))
    return [name for name in names if name[0].islower() and name != "structure_needs_at_least_one_member"]


def plain_data(value: Any, longest: int | None = None) -> Any:
    """Return a message as mappings, lists, numbers and texts, those that are longer than `longest` cut."""
    if is_dataclass(value) and not isinstance(value, type):
        return {name: plain_data(getattr(value, name), longest) for name in field_names(value)}
    if isinstance(value, Mapping):
        return {key: plain_data(item, longest) for key, item in value.items()}
    if isinstance(value, str):
        return value if longest is None or len(value) <= longest else f"{value[:longest]}..."
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        items = [plain_data(item, longest) for item in value[:longest]]
        return items if longest is None or len(value) <= longest else [*items, "..."]
    return value
