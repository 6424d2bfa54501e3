"""``drake-twin topic echo``: the messages of a topic, as ``ros2 topic echo`` prints them."""

import argparse
import sys
import time
from array import array
from collections.abc import Iterator, Mapping
from dataclasses import is_dataclass
from functools import reduce
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.program import ArgumentParser
from drake_twin.tools.verb import Arrivals, positive

if TYPE_CHECKING:
    from drake_twin.client import Client

_IN_IDL = {"float32": "float", "float64": "double", "bool": "boolean", "byte": "octet", "char": "uint8"}  # of rosidl
_LONGEST = 128  # as `ros2 topic echo` cuts sequences and texts


def add_echo(parser: ArgumentParser) -> None:
    """Add the arguments of ``echo``."""
    parser.add_argument("topic_name", metavar="TOPIC", help="the topic")
    parser.add_argument("message_type", metavar="TYPE", nargs="?", help="its type; by default what the graph says")
    parser.add_argument("--once", action="store_true", help="end after the first message")
    parser.add_argument("--timeout", type=positive, metavar="S", help="end after so many seconds")
    parser.add_argument("--field", help="print only this field, for example pose.pose.position")
    parser.add_argument("--filter", metavar="PYTHON", help="print a message m only where this is true: 'm.data > 1'")
    parser.add_argument("--csv", action="store_true", help="print the values of a message on one line, with commas")
    parser.add_argument("--no-arr", action="store_true", help="print the types of arrays, not their values")
    parser.add_argument("--no-str", action="store_true", help="print the lengths of texts, not the texts")
    parser.add_argument("--no-lost-messages", action="store_true", help="do not tell that messages were lost")
    parser.add_argument("-f", "--full-length", action="store_true", help="do not cut long arrays and texts")
    parser.add_argument(
        "-l", "--truncate-length", type=int, metavar="N", default=_LONGEST, help="where to cut them (default: 128)"
    )
    parser.add_argument("--flow-style", action="store_true", help="print a message on one line")


def echo(client: "Client", options: argparse.Namespace) -> int:
    """Print messages until there have been enough, or Ctrl-C."""
    if options.truncate_length < 0:
        raise InputError(f"--truncate-length {options.truncate_length} is negative")
    try:
        wanted = None if options.filter is None else compile(options.filter, "--filter", "eval")
    except SyntaxError as error:
        raise InputError(f"--filter {options.filter!r} is not an expression of Python: {error.msg}") from None
    arrivals, lost = Arrivals(), 0
    client.subscribe(options.topic_name, arrivals.put, options.message_type)
    try:
        for message in _messages(arrivals, options.timeout):
            if arrivals.lost > lost and not options.no_lost_messages:
                change, lost = arrivals.lost - lost, arrivals.lost
                text = f"A message was lost!!!\n\ttotal count change:{change}\n\ttotal count: {lost}\n---"
                print(text, file=sys.stderr)
            chosen, kind = (message, None) if options.field is None else _field(message, options.field)
            if wanted is not None and not eval(wanted, {"m": chosen}):  # the user's own expression
                continue
            print(_text(chosen, options) if kind is None else f"{_field_text(chosen, kind)}\n---", flush=True)
            if options.once:
                break
    except KeyboardInterrupt:
        pass
    return 0


def _messages(arrivals: Arrivals, seconds: float | None) -> Iterator[Any]:
    end = None if seconds is None else time.monotonic() + seconds
    while end is None or time.monotonic() < end:
        message = arrivals.get(3600.0 if end is None else end - time.monotonic())
        if message is not None:
            yield message


def _field(message: Any, path: str) -> tuple[Any, Any]:
    """Return what a message has in a field, and how rosbags describes the field; None where it is a message, too."""
    from drake_twin.messages.interface_types import fields_of
    from drake_twin.messages.text import field_names

    kind = None
    for name in filter(None, path.split(".")):
        known = field_names(message) if is_dataclass(message) else []
        if name not in known:
            raise InputError(f"--field {path}: unknown field {name!r}", value=name, valid=known)
        kind = dict(fields_of(str(getattr(message, "__msgtype__", "")))[1])[name]
        message = getattr(message, name)
    return message, None if is_dataclass(message) else kind


def _field_text(value: Any, kind: Any) -> str:
    """Return a field as `print` shows it in rclpy: sequences of numbers are Python's arrays, fixed ones NumPy's."""
    from drake_twin.messages.text import call_text

    if hasattr(value, "tolist") and value.dtype == bool:
        value = value.tolist()
    if hasattr(value, "tolist") and kind[0].name == "SEQUENCE":
        return repr(array({"l": "q", "L": "Q"}.get(value.dtype.char, value.dtype.char), value.tolist()))
    return call_text(value) if isinstance(value, list) else str(value)


def _text(message: Any, options: argparse.Namespace) -> str:
    from drake_twin.messages.text import message_text

    longest = None if options.full_length else options.truncate_length
    if is_dataclass(message) and (options.no_arr or options.no_str):
        message = _abbreviated(message, options)
    if options.csv and (is_dataclass(message) or isinstance(message, Mapping)):
        return _csv(message, longest)
    return message_text(message, longest, flow_style=options.flow_style)


def _abbreviated(value: Any, options: argparse.Namespace, kind: str | None = None) -> Any:
    """Return a message, or a value of it, with the types of its arrays and the lengths of its texts in their place."""
    from drake_twin.messages.interface_types import fields_of

    if kind is not None and options.no_arr:
        return f"<{kind.format(length=len(value))}>"
    if isinstance(value, str):
        return f"<string length: <{len(value)}>>" if options.no_str else value
    if isinstance(value, list):
        return [_abbreviated(item, options) for item in value]
    if not is_dataclass(value):
        return value
    _, fields = fields_of(str(getattr(value, "__msgtype__", "")))
    return {name: _abbreviated(getattr(value, name), options, _array_type(details)) for name, details in fields}


def _array_type(field: Any) -> str | None:
    """Return how rosidl tells an array of a message's field, as rosbags describes it; None for other fields."""
    node, details = field
    if node.name not in ("ARRAY", "SEQUENCE"):
        return None
    (_, element), size = details
    name = element[0] if isinstance(element, tuple) else element
    name = _IN_IDL.get(name, name)
    if node.name == "ARRAY":
        return f"array type: {name}[{size}]"
    return f"sequence type: {name}{f'[{size}]' if size else ''}, length: {{length}}"


def _csv(value: Any, longest: int | None) -> str:
    """Return the values in a message, arrays and texts cut; what is empty at the start has no comma, as in ROS."""
    if is_dataclass(value) and not isinstance(value, type):
        from drake_twin.messages.text import field_names

        value = {name: getattr(value, name) for name in field_names(value)}
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, Mapping):
        texts = [_csv(item, longest) for item in value.values()]
    elif isinstance(value, list):
        texts = [_csv(item, longest) for item in value[:longest]]
        texts += ["..."] if longest is not None and len(value) > longest else []
    else:
        text = str(value)
        return (
            f"{text[:longest]}..." if isinstance(value, str) and longest is not None and len(text) > longest else text
        )
    return reduce(lambda found, text: f"{found},{text}" if found else text, texts, "")
