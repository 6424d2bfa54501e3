"""Topics, messages and controllers of a twin, as ROS 2's command line tools print them."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import yaml

from drake_twin.twin.twin import Twin

_LONGEST = 128  # as `ros2 topic echo` cuts sequences and texts


def topics_text(twin: Twin) -> str:
    """Return what ``ros2 topic list -t`` prints, followed by the actions."""
    lines = [f"{topic} [{kind}]" for topic, kind in sorted(twin.topics().items())]
    lines += [f"{action} [{kind}] (action)" for action, kind in sorted(twin.actions().items())]
    return "\n".join(lines)


def message_text(message: object) -> str:
    """Return a message as ``ros2 topic echo`` prints it."""
    text: str = yaml.safe_dump(_plain(message), sort_keys=False, allow_unicode=True, width=10_000)
    return f"{text}---"


def controllers_text(twin: Twin) -> str:
    """Return what ``ros2 control list_controllers`` prints, for each controller manager."""
    lines = []
    for plan in twin.plans:
        states = twin.controller_manager(plan.name).list_controllers()
        lines.append(f"{plan.robot.topic_namespace}/controller_manager:")
        if not states:
            lines.append("  No controllers are currently loaded!")
        names = max((len(item.name) for item in states), default=0)
        types = max((len(item.type) for item in states), default=0)
        lines += [f"  {item.name:<{names}} {item.type:<{types}} {item.state}" for item in states]
    return "\n".join(lines)


def _plain(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        # The message type in rosbags' classes is not a field of the message.
        return {item.name: _plain(getattr(value, item.name)) for item in fields(value) if item.name != "__msgtype__"}
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, str):
        return value if len(value) <= _LONGEST else f"{value[:_LONGEST]}..."
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        items = [_plain(item) for item in value[:_LONGEST]]
        return [*items, "..."] if len(value) > _LONGEST else items
    return value
