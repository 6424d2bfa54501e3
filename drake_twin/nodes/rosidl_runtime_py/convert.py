"""Stand-in for ``rosidl_runtime_py.convert``: messages as YAML, as mappings and as comma-separated values."""

import array
import sys
from collections import OrderedDict
from collections.abc import Mapping
from typing import Any

import numpy as np
import yaml

from drake_twin.dataclass import dataclass

_ARRAYS = (list, tuple, array.array, np.ndarray)


@dataclass(frozen=True)
class _Short:
    """How much is left out."""

    length: int | None = None
    arrays: bool = False
    strings: bool = False


class _Dumper(yaml.SafeDumper):
    """Writes mappings in their order."""


_Dumper.add_representer(OrderedDict, lambda dumper, data: dumper.represent_dict(data.items()))


def get_message_slot_types(msg: Any) -> "OrderedDict[str, str]":
    """Return the type of each field; here it is the text of its definition."""
    return OrderedDict(msg.get_fields_and_field_types())


def message_to_yaml(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
    flow_style: bool = False,
) -> str:
    data = message_to_ordereddict(msg, truncate_length=truncate_length, no_arr=no_arr, no_str=no_str)
    options: dict[str, Any] = {"allow_unicode": True, "width": sys.maxsize, "default_flow_style": flow_style}
    return str(yaml.dump(data, Dumper=_Dumper, sort_keys=False, **options))


def message_to_csv(msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False) -> str:
    short = _Short(truncate_length, no_arr, no_str)
    return ",".join(_text(getattr(msg, name), short, kind) for name, kind in get_message_slot_types(msg).items())


def message_to_ordereddict(
    msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> "OrderedDict[str, Any]":
    short = _Short(truncate_length, no_arr, no_str)
    kinds = get_message_slot_types(msg)
    return OrderedDict((name, _plain(getattr(msg, name), short, kind)) for name, kind in kinds.items())


def _plain(value: Any, short: _Short, kind: str = "") -> Any:
    """Return a value as YAML and JSON have it."""
    if isinstance(value, bytes):
        text = "".join(map(chr, value))
        return text if short.length is None or len(value) <= short.length else text[: short.length] + "..."
    if isinstance(value, str):
        return _shortened(value, short)
    if isinstance(value, _ARRAYS):
        if short.arrays and kind:
            return _kind_of(value, kind)
        own = tuple if isinstance(value, tuple) else list
        items = [_plain(item, short) for item in value[: short.length]]
        return own(items + (["..."] if short.length is not None and len(value) > short.length else []))
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, bool | int | float):
        return value
    if isinstance(value, Mapping):
        return {_plain(key, _Short()): _plain(item, short) for key, item in value.items()}
    return message_to_ordereddict(value, truncate_length=short.length, no_arr=short.arrays, no_str=short.strings)


def _text(value: Any, short: _Short, kind: str = "") -> str:
    if isinstance(value, _ARRAYS):
        if short.arrays and kind:
            return _kind_of(value, kind)
        items = [_text(item, short) for item in value[: short.length]]
        return ",".join(items + (["..."] if short.length is not None and len(value) > short.length else []))
    if isinstance(value, str):
        return _shortened(value, short)
    if isinstance(value, bytes):
        return str(value if short.length is None or len(value) <= short.length else value[: short.length] + b"...")
    if isinstance(value, bool | int | float | np.number):
        return str(value)
    return message_to_csv(value, truncate_length=short.length, no_arr=short.arrays, no_str=short.strings)


def _shortened(text: str, short: _Short) -> str:
    if short.strings:
        return f"<string length: <{len(text)}>>"
    return text if short.length is None or len(text) <= short.length else text[: short.length] + "..."


def _kind_of(value: Any, kind: str) -> str:
    """Return the type of an array, in place of its items."""
    inner, _, bound = kind.removeprefix("sequence<").removesuffix(">").partition(", ")
    if kind.startswith("sequence<"):
        return f"<sequence type: {inner}{f'[{bound}]' if bound else ''}, length: {len(value)}>"
    return f"<array type: {kind}>"
