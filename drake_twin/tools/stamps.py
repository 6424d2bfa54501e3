"""Times that ``topic pub`` fills in, as ``ros2 topic pub`` does: ``auto`` for a header, ``now`` for a time."""

from collections.abc import Mapping
from typing import Any

_HEADER, _TIME = "std_msgs/msg/Header", "builtin_interfaces/msg/Time"
_WORDS = {_HEADER: "auto", _TIME: "now"}

Path = tuple[str | int, ...]


def without_words(kind: str, values: Any, path: Path = ()) -> tuple[Any, list[Path]]:
    """Return a message's fields without those words, and where in the message the times are that they ask for."""
    from drake_twin.messages.interface_types import fields_of

    if not isinstance(values, Mapping):
        return values, []
    types = {name: _message_type(details) for name, details in fields_of(kind)[1]}
    plain, found = dict(values), []
    for name, value in values.items():
        its = types.get(name)
        if its is None:
            continue
        if value == _WORDS.get(its):
            plain[name] = {}
            found.append((*path, name, "stamp") if its == _HEADER else (*path, name))
        elif isinstance(value, list):
            items = [without_words(its, item, (*path, name, index)) for index, item in enumerate(value)]
            plain[name] = [item for item, _ in items]
            found += [place for _, places in items for place in places]
        else:
            plain[name], places = without_words(its, value, (*path, name))
            found += places
    return plain, found


def set_times(message: Any, paths: list[Path], now: int) -> None:
    """Set the times in a message (ns)."""
    for path in paths:
        time = message
        for step in path:
            time = time[step] if isinstance(step, int) else getattr(time, step)
        time.sec, time.nanosec = divmod(now, 1_000_000_000)


def _message_type(field: Any) -> str | None:
    """Return the message type of a field or its elements, as rosbags describes it; None for numbers and texts."""
    node, details = field
    if node.name in ("ARRAY", "SEQUENCE"):
        return _message_type(details[0])
    return str(details) if node.name == "NAME" else None
