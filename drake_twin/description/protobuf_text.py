"""Messages in the text format of Protocol Buffers, as gz's tools and plugins have them: ``linear: {x: 1}``."""

import re
from collections.abc import Iterator
from typing import Any

from drake_twin.values import number_or_none

_TOKEN = re.compile(r"""\s+|\#[^\n]*|(?P<token>"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*'|[\w.+-]+|[:{}<>\[\],;])""")
_ESCAPE = re.compile(r"\\(?:([0-7]{1,3})|x([0-9a-fA-F]{1,2})|(.))")
_CONTROL = {"n": "\n", "t": "\t", "r": "\r", "a": "\a", "b": "\b", "f": "\f", "v": "\v"}
_ENDS = {"{": "}", "<": ">"}
_DEEPEST = 30

Fields = dict[str, list[Any]]


def read_fields(text: str) -> Fields:
    """Read a message: field → its values, in order.

    A value is a number, a text, or the fields of a message; words such as ``true`` are `Word`.

    Raises:
        ValueError: If the text is not such a message; the message says what is wrong.
    """
    return _Reader(text).fields("", 0)


def read_value(text: str) -> Any:
    """Read the value of a field.

    Raises:
        ValueError: If the text is not one value; the message says what is wrong.
    """
    reader = _Reader(text)
    value = reader.value(0)
    if reader.next:
        raise ValueError(f"{reader.next!r} is left after the value")
    return value


class Word(str):
    """A value that is a word: ``true``, ``false`` or one of an enumeration."""

    __slots__ = ()


class _Reader:
    def __init__(self, text: str):
        self._tokens = _tokens(text)
        self.next = next(self._tokens, "")

    def fields(self, end: str, depth: int) -> Fields:
        """Read fields up to an end, which is read, too."""
        if depth > _DEEPEST:
            raise ValueError("it is too deep")
        found: Fields = {}
        while self.next != end:
            name = self._take()
            if not name.isidentifier():
                raise ValueError(f"{name!r} is not a field" if name else f"{end!r} is missing")
            has_colon = self.next == ":"
            if has_colon:
                self._take()
            if not has_colon and self.next not in ("{", "<"):
                raise ValueError(f"':' is missing after {name!r}")
            found.setdefault(name, []).extend(self._list(depth) if self.next == "[" else [self.value(depth)])
            if self.next in (",", ";"):
                self._take()
        self._take()
        return found

    def value(self, depth: int) -> Any:
        """Read one value."""
        token = self._take()
        if token in _ENDS:
            return self.fields(_ENDS[token], depth + 1)
        if token[:1] in ("'", '"') and token:
            text = _unescaped(token[1:-1])
            while self.next[:1] in ("'", '"') and self.next:
                text += _unescaped(self._take()[1:-1])
            return text
        number = _number(token)
        if number is not None:
            return number
        if not token.isidentifier():
            raise ValueError(f"{token!r} is not a value" if token else "a value is missing")
        return Word(token)

    def _list(self, depth: int) -> list[Any]:
        self._take()
        values: list[Any] = []
        while self.next != "]":
            values.append(self.value(depth))
            if self.next == ",":
                self._take()
            elif self.next != "]":
                raise ValueError("']' is missing")
        self._take()
        return values

    def _take(self) -> str:
        token, self.next = self.next, next(self._tokens, "")
        return token


def _tokens(text: str) -> Iterator[str]:
    place = 0
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None:
            raise ValueError(f"{text[place]!r} is out of place")
        place = match.end()
        if match["token"]:
            yield match["token"]


def _number(token: str) -> float | int | None:
    if re.fullmatch(r"[+-]?[0-9]{1,20}", token):
        return int(token)
    if re.fullmatch(r"[+-]?0[xX][0-9a-fA-F]{1,16}", token):
        return int(token, 16)
    return number_or_none(token.rstrip("fF") if token[:1].isdigit() or token[:1] in "+-." else token)


def _unescaped(text: str) -> str:
    def character(match: re.Match[str]) -> str:
        octal, hexadecimal, letter = match.groups()
        if letter is not None:
            return _CONTROL.get(letter, letter)
        return chr(int(octal, 8) if octal else int(hexadecimal, 16))

    return _ESCAPE.sub(character, text)
