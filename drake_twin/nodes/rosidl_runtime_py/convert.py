"""Messages as dictionaries, YAML and lines of values."""

from collections import OrderedDict
from typing import Any

import yaml

_Shown = Any  # of a message: numbers, strings, lists, dictionaries


def message_to_ordereddict(
    msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> "OrderedDict[str, _Shown]":
    """Return a message as a dictionary of dictionaries, lists, numbers and strings.

    Args:
        msg: The message.
        truncate_length: The longest length of a string or sequence; ``...`` follows what is cut.
        no_arr: Whether sequences are told by their lengths only.
        no_str: Whether strings are told by their lengths only.
    """
    found: OrderedDict[str, _Shown] = OrderedDict()
    for name, kind in msg.get_fields_and_field_types().items():
        found[name] = _value(getattr(msg, name), kind, truncate_length, no_arr, no_str)
    return found


def message_to_yaml(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
    flow_style: bool = False,
) -> str:
    """Return a message as YAML; see `message_to_ordereddict`."""
    found = message_to_ordereddict(msg, truncate_length=truncate_length, no_arr=no_arr, no_str=no_str)
    text: str = yaml.safe_dump(
        _plain(found), sort_keys=False, allow_unicode=True, width=float("inf"), default_flow_style=flow_style
    )
    return text


def message_to_csv(msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False) -> str:
    """Return the values of a message in one line, with commas between them; see `message_to_ordereddict`."""
    found = message_to_ordereddict(msg, truncate_length=truncate_length, no_arr=no_arr, no_str=no_str)
    return _line(found)


def _value(value: Any, kind: str, longest: int | None, no_arr: bool, no_str: bool) -> _Shown:
    if hasattr(value, "get_fields_and_field_types"):
        return message_to_ordereddict(value, truncate_length=longest, no_arr=no_arr, no_str=no_str)
    if isinstance(value, str | bytes):
        text = value if isinstance(value, str) else value.decode("latin-1")
        if no_str and isinstance(value, str):
            return f"<string length: <{len(text)}>>"
        return text if longest is None or len(text) <= longest else text[:longest] + "..."
    if isinstance(value, bool | int | float):
        return value
    items = value.tolist() if hasattr(value, "tolist") else list(value)
    if no_arr:
        element = kind.removeprefix("sequence<").rstrip(">").partition("[")[0].partition(",")[0]
        is_sequence = kind.startswith("sequence")
        return f"<sequence type: {element}, length: {len(items)}>" if is_sequence else f"<array type: {kind}>"
    shown = items if longest is None else items[:longest]
    found = [_value(each, "", longest, no_arr, no_str) for each in shown]
    return found if len(shown) == len(items) else [*found, "..."]


def _plain(value: _Shown) -> _Shown:
    if isinstance(value, dict):
        return {name: _plain(each) for name, each in value.items()}
    return [_plain(each) for each in value] if isinstance(value, list) else value


def _line(value: _Shown) -> str:
    """Return values with commas between them, none before the first that is not empty."""
    if not isinstance(value, dict | list):
        return str(value)
    found = ""
    for each in value.values() if isinstance(value, dict) else value:
        found += ("," if found else "") + _line(each)
    return found


def get_message_slot_types(msg: Any) -> dict[str, str]:
    """Return the type of each field; here it is the text of its definition."""
    return dict(msg.get_fields_and_field_types())
