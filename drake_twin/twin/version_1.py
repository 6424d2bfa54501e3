"""Saved files of version 1, converted to the present version.

Version 1 named classes by their modules (``drake_twin.systems.controller:Sample``), kept no parameters of the plant,
and had texts where a scenario has findings now.
"""

from typing import Any

import yaml

from drake_twin.description.bounded_yaml import load_yaml


def converted_state(data: dict[str, Any]) -> dict[str, Any]:
    """Return the entries of a saved state."""
    return {"parameters": {}, **_renamed(data), "scenario": _converted_scenario(data.get("scenario"))}


def converted_recording(data: dict[str, Any]) -> dict[str, Any]:
    """Return the entries of a recording."""
    recording = _renamed(data.get("recording"))
    if isinstance(recording, dict) and isinstance(recording.get("start"), dict):
        start = recording["start"]
        start["scenario"] = _converted_scenario(start.get("scenario"))
        start.setdefault("parameters", {"!": "mapping", "items": []})
    return {"recording": recording}


def _renamed(value: Any) -> Any:
    """Name classes as they are registered: by their own name, without the module."""
    if isinstance(value, list):
        if len(value) == 2 and value[0] == "!" and isinstance(value[1], str):  # of plain data within plain data
            return ["!", _name(value[1])]
        return [_renamed(item) for item in value]
    if not isinstance(value, dict):
        return value
    kind = value.get("!")
    renamed = {key: _renamed(item) for key, item in value.items()}
    if isinstance(kind, str):
        renamed["!"] = _name(kind)
    return renamed


def _name(kind: str) -> str:
    return f"{kind.rpartition(':')[2]}@1" if ":" in kind else kind


def _converted_scenario(text: Any) -> Any:
    if not isinstance(text, str):
        return text
    try:
        data = load_yaml(text)
    except yaml.YAMLError:
        return text  # refused where it is read
    if not isinstance(data, dict) or "not_started" not in data:
        return text
    data["findings"] = [{"kind": "not started", "what": what} for what in data.pop("not_started")]
    return yaml.safe_dump(data, sort_keys=False, allow_unicode=True)
