"""What the form of a topic that something listens to begins with."""

from math import isfinite
from typing import Any

import yaml

from drake_twin import messages
from drake_twin.cockpit.joint_commands import JointCommands
from drake_twin.messages.interface_types import make
from drake_twin.messages.text import plain_data
from drake_twin.twin.twin import Twin


def form_of(twin: Twin, topic: str) -> dict[str, Any]:
    """Return a message to publish: the present command, or else one that changes nothing.

    Returns:
        The message as ``fields`` and as ``text`` in YAML; ``labels`` names the elements of ``data`` of a controller of
        joints, and is empty for others.
    """
    commands = JointCommands(twin)
    present = twin.graph.command(topic)
    data: Any = {} if present is None else present
    if topic in commands.groups:
        data = commands.message(topic)
    fields = plain_data(messages.message(twin.built.commanded[topic].type, data))
    short = data if topic in commands.groups else fields
    labels = [f"{claim.joint} {claim.name}" for claim in twin.graph.command_limits(topic)]
    return {"fields": _finite(fields), "labels": labels, "text": _yaml(short)}


def empty_form(type_: str) -> dict[str, Any]:
    """Return a message of a type with ROS's default values, as `form_of` does.

    Raises:
        ValueError: If the type is unknown.
    """
    fields = plain_data(make(type_, {}))
    return {"fields": _finite(fields), "labels": [], "text": _yaml(fields)}


def _yaml(data: Any) -> str:
    return str(yaml.safe_dump(data, sort_keys=False, allow_unicode=True, default_flow_style=None, width=60))


def _finite(value: Any) -> Any:
    """Return plain data with texts for the numbers that JSON cannot hold."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return value if not isinstance(value, float) or isfinite(value) else str(value)
