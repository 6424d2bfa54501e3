"""Messages as JSON: their fields by name, and the JSON Schema of their types."""

import json
import math
from typing import Any

from drake_twin.messages import EMPTY
from drake_twin.messages.interface_types import fields_of, make
from drake_twin.messages.text import plain_data

_NUMBERS = {"bool": "boolean", "float32": "number", "float64": "number", "string": "string", "wstring": "string"}


def json_schema(name: str) -> dict[str, Any]:
    """Return the JSON Schema of a message type.

    Raises:
        ValueError: If the type is unknown.
    """
    fields = {own: _field(field) for own, field in fields_of(name)[1] if own != EMPTY}
    return {"title": name, "type": "object", "properties": fields}


def json_data(message: Any) -> bytes:
    """Return a message as JSON. Numbers that are not finite are null: JSON has none of them."""
    return json.dumps(_finite(plain_data(message))).encode()


def from_json(name: str, data: bytes) -> Any:
    """Return the message in JSON; fields that are left out have their defaults.

    Raises:
        ValueError: If the type is unknown, or the data is not such a message.
    """
    try:
        return make(name, json.loads(data))
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def _field(field: tuple[Any, Any]) -> dict[str, Any]:
    from rosbags.interfaces import Nodetype

    node, details = field
    if node == Nodetype.NAME:
        return json_schema(details)
    if node == Nodetype.BASE:
        return {"type": _NUMBERS.get(details[0], "integer")}
    return {"type": "array", "items": _field(details[0])}


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _finite(item) for name, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
