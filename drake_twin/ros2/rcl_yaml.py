"""Parameters files and values as rcl reads them: its scalars are not those of YAML 1.1.

Source: ros2/rcl (jazzy), rcl_yaml_param_parser/src/parse.c.
"""

import re
from collections.abc import Callable, Iterator
from math import copysign
from typing import Any

import yaml

from drake_twin.description.bounded_yaml import LOADER

Scalar = bool | int | float | str
Parameters = dict[str, dict[str, Any]]  # node, as it is written → parameter → value, in order of first appearance

_TRUE = frozenset(("y", "Y", *(f(word) for word in ("yes", "true", "on") for f in (str, str.title, str.upper))))
_FALSE = frozenset(("n", "N", *(f(word) for word in ("no", "false", "off") for f in (str, str.title, str.upper))))
_INTEGER = re.compile(r"\s*([+-]?)(0[xX][0-9A-Fa-f]+|0[0-7]*|[1-9][0-9]*)")
_DOUBLE = re.compile(r"\s*[+-]?((\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|inf(inity)?|nan)", re.IGNORECASE)
_DOTTED = re.compile(r"\.(nan|NaN|NAN)|[+-]?\.(inf|Inf|INF)")
_KEY = "ros__parameters"
_NODE = re.compile(r"/?((\*\*?|[A-Za-z_]\w*)/)*(\*\*?|[A-Za-z_]\w*)", re.ASCII)


class RclYamlError(ValueError):
    """Raised for what rcl does not read as parameters."""


def scalar(text: str, *, is_quoted: bool = False, tag: str | None = None) -> Scalar:
    """Return a scalar as rcl takes it: ``1e3`` is a double, ``y`` a boolean and ``~`` a string."""
    if is_quoted or tag == "tag:yaml.org,2002:str":
        return text
    if text in _TRUE or text in _FALSE:
        return text in _TRUE
    if found := _INTEGER.fullmatch(text):
        digits = found[2]
        base = 16 if digits[:2] in ("0x", "0X") else 8 if digits[0] == "0" else 10
        value = int(digits, base) * (-1 if found[1] == "-" else 1)
        if -(2**63) <= value < 2**63:
            return value
    if _DOTTED.fullmatch(text):
        return copysign(float(text.lstrip("+-.")), -1.0 if text[0] == "-" else 1.0)
    if _DOUBLE.fullmatch(text):
        return float(text)
    return text


def read_value(text: str) -> Any:
    """Return a parameter's value as rcl reads what follows ``-p NAME:=``.

    Raises:
        RclYamlError: If rcl refuses it.
    """
    values = _Values()
    for event in _events(text):
        if isinstance(event, yaml.ScalarEvent):
            values.put(event)
        elif isinstance(event, yaml.SequenceStartEvent):
            values.begin()
        elif isinstance(event, yaml.SequenceEndEvent):
            values.is_open = False
        elif not isinstance(event, _MARKS):
            raise RclYamlError("Unknown YAML event")
    return values.found


def read_parameters(text: str, into: Parameters) -> None:
    """Read a parameters file.

    Args:
        text: Its text.
        into: Nodes and their parameters, to which those of the file are added.

    Raises:
        RclYamlError: If rcl refuses it.
    """
    _File(into).read(text)


class _Values:
    """The value of one parameter, from its scalars."""

    def __init__(self) -> None:
        self.found: Any = None
        self.is_open = False  # within a sequence
        self._kind: type | None = None

    def begin(self) -> None:
        """Begin a sequence; one within another begins it again."""
        self.is_open, self._kind = True, None

    def put(self, event: yaml.ScalarEvent) -> None:
        line = _line(event)
        is_quoted = event.style in ("'", '"')
        if not is_quoted and not event.value:
            raise RclYamlError(f"No value at line {line}")
        value = scalar(event.value, is_quoted=is_quoted, tag=event.tag)
        if not self.is_open:
            self.found = value
            return
        if self._kind is None:
            self._kind, self.found = type(value), []
        elif type(value) is not self._kind:
            raise RclYamlError(f"Sequence should be of same type, but {value!r} is of another one at line {line}")
        self.found.append(value)


class _File:
    """What has been read of a parameters file."""

    def __init__(self, into: Parameters):
        self._found = into
        self._keys: list[str] = []  # those of the mappings that are open, without that of the document
        self._depth = 0
        self._key: str | None = None
        self._name: tuple[str, str] | None = None  # the parameter's node and name
        self._values = _Values()

    def read(self, text: str) -> None:
        """Read events as rcl does, which never looks ahead."""
        for event in _events(text):
            if isinstance(event, yaml.AliasEvent):
                raise RclYamlError(f"Will not support aliasing at line {_line(event)}")
            if not isinstance(event, _MARKS):
                _HANDLERS[type(event)](self, event)

    def begin_mapping(self, event: yaml.MappingStartEvent) -> None:
        """Open a mapping: that of the document, of a node, of its parameters or of some of them."""
        self._depth += 1
        if self._key is not None:
            self._keys.append(self._key)
            if self._key == _KEY and _KEY not in self._keys[:-1]:
                node = "/".join(self._keys[:-1])
                if not node:
                    raise RclYamlError(f"There are no node names before {_KEY} at line {_line(event)}")
                if not _NODE.fullmatch(node):
                    raise RclYamlError(f"{node!r} is not the name of a node, at line {_line(event)}")
                self._found.setdefault(node, {})
        self._key = None

    def end_mapping(self, event: yaml.MappingEndEvent) -> None:
        """Close a mapping; one without parameters is a parameter without a value."""
        self._depth -= 1
        if self._name is not None and not self._values.is_open and self._values.found is None:
            self._store()
        if self._keys:
            self._keys.pop()
        self._key = None

    def begin_sequence(self, event: yaml.SequenceStartEvent) -> None:
        """Begin the items of a parameter."""
        line = _line(event)
        if self._key is None:
            raise RclYamlError(f"Sequences cannot be key at line {line}")
        if self._name is None:
            raise RclYamlError(f"Sequences can only be values and not keys in params. Error at line {line}")
        self._values.begin()

    def end_sequence(self, event: yaml.SequenceEndEvent) -> None:
        """Take the items."""
        if self._values.is_open:
            self._values.is_open = False
            self._store()

    def scalar(self, event: yaml.ScalarEvent) -> None:
        """Take a key or a value."""
        line = _line(event)
        if self._key is None:
            if not event.value:
                raise RclYamlError(f"No key at line {line}")
            if not self._depth:
                raise RclYamlError(f"Cannot have a value before {_KEY} at line {line}")
            self._key = event.value
            self._name = self._parameter(event.value)
            if not self._values.is_open:
                self._values = _Values()
            return
        if self._name is None:
            raise RclYamlError(f"Cannot have a value before {_KEY} at line {line}")
        self._values.put(event)
        if not self._values.is_open:
            self._store()

    def _parameter(self, key: str) -> tuple[str, str] | None:
        if _KEY not in self._keys:
            return None
        start = self._keys.index(_KEY)
        return "/".join(self._keys[:start]), ".".join([*self._keys[start + 1 :], key])

    def _store(self) -> None:
        assert self._name is not None
        node, name = self._name
        known = self._found[node]
        known[name] = known.get(name) if self._values.found is None else self._values.found
        self._key = self._name = None


_MARKS = (yaml.StreamStartEvent, yaml.StreamEndEvent, yaml.DocumentStartEvent, yaml.DocumentEndEvent)
_HANDLERS: dict[type, Callable[[_File, Any], None]] = {
    yaml.MappingStartEvent: _File.begin_mapping,
    yaml.MappingEndEvent: _File.end_mapping,
    yaml.SequenceStartEvent: _File.begin_sequence,
    yaml.SequenceEndEvent: _File.end_sequence,
    yaml.ScalarEvent: _File.scalar,
}


def _line(event: yaml.Event) -> int:
    assert event.start_mark is not None
    return event.start_mark.line + 1


def _events(text: str) -> Iterator[Any]:
    try:
        yield from yaml.parse(text, Loader=LOADER)
    except yaml.YAMLError as error:
        raise RclYamlError(f"Error parsing a event: {' '.join(str(error).split())}") from None
