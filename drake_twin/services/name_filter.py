"""A regular expression on names that anyone may send: its time grows with the name's length only.

Python's matcher goes back and tries again: ``^(a|a)*$`` takes hours for a name of 60 letters, while the simulation
stands still. So this one follows all ways at once (K. Thompson, 1968). It takes POSIX extended regular expressions, as
``simulation_interfaces`` has them, and ``\\d``, ``\\w``, ``\\s`` and ``(?:…)``; what needs going back is refused.
"""

import re
import warnings
from collections.abc import Callable
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError

_LONGEST = 256  # characters
_DEEPEST = 30  # groups within groups
_MOST_STATES = 2000
_ONE = re.compile(r"\\.|\[\^?\]?(?:\[:\w+:\]|[^\]])*\]|[^\\\[]", re.DOTALL)
_REPEATED = re.compile(r"([*+?])|\{(\d{1,3})(?:(,)(\d{0,3}))?\}")
_CLASSES = {
    "alpha": "a-zA-Z",
    "digit": "0-9",
    "alnum": "a-zA-Z0-9",
    "upper": "A-Z",
    "lower": "a-z",
    "space": r"\s",
    "xdigit": "0-9a-fA-F",
    "punct": r"!-/:-@\[-`{-~",
    "blank": r" \t",
}

_Build = Callable[[int], int]  # adds the states of a part, which lead to a state; returns the first


@dataclass
class _State:
    """A state: its kind, the test of one character, and where it leads to."""

    kind: str
    test: Callable[[str], Any] | None
    following: list[int]


class NameFilter:
    """A regular expression that accepts the names in which it is found.

    Args:
        text: The regular expression.

    Raises:
        InputError: If it is invalid, or needs a matcher that goes back.
    """

    def __init__(self, text: str):
        if len(text) > _LONGEST:
            raise InputError(f"the filter has more than {_LONGEST} characters")
        self._text, self._at, self._count = text, 0, 0
        self._states = [_State("accept", None, [])]
        build = self._alternatives(0)
        if self._at < len(text):
            raise self._wrong("unbalanced parenthesis")
        self._first = build(0)

    def accepts(self, name: str) -> bool:
        """Tell whether it is found in a name."""
        present: set[int] = set()
        for place in range(len(name) + 1):
            following: set[int] = set()
            pending, seen = [*present, self._first], set()
            while pending:
                number = pending.pop()
                if number in seen:
                    continue
                seen.add(number)
                state = self._states[number]
                if state.kind == "accept":
                    return True
                if state.test is not None:
                    if place < len(name) and state.test(name[place]):
                        following.update(state.following)
                elif state.kind == "any" or place == (0 if state.kind == "^" else len(name)):
                    pending += state.following
            present = following
        return False

    def _alternatives(self, depth: int) -> _Build:
        if depth > _DEEPEST:
            raise self._wrong(f"more than {_DEEPEST} groups within each other")
        branches = [self._branch(depth)]
        while self._takes("|"):
            branches.append(self._branch(depth))
        if len(branches) == 1:
            return branches[0]
        return lambda after: self._add("any", [branch(after) for branch in branches])

    def _branch(self, depth: int) -> _Build:
        pieces: list[_Build] = []
        while self._at < len(self._text) and self._text[self._at] not in "|)":
            pieces.append(self._repeated(self._atom(depth)))

        def build(after: int) -> int:
            for piece in reversed(pieces):
                after = piece(after)
            return after

        return build

    def _atom(self, depth: int) -> _Build:
        if self._takes("("):
            if self._takes("?") and not self._takes(":"):
                raise self._wrong("(?…) is unknown in POSIX")
            inner = self._alternatives(depth + 1)
            if not self._takes(")"):
                raise self._wrong("missing )")
            return inner
        for mark in "^$":
            if self._takes(mark):
                return lambda after: self._add(mark, [after])
        one = _ONE.match(self._text, self._at)
        if one is None or re.fullmatch(r"[*+?{]|\\[^\WdDwWsS_]", one[0]):
            raise self._wrong("nothing to repeat, a bracket that is not closed, or an escape that POSIX does not have")
        self._at = one.end()
        text = re.sub(r"\[:(\w+):\]", lambda name: _CLASSES.get(name[1], "[:"), one[0]) if one[0][0] == "[" else one[0]
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", FutureWarning)
                test = re.compile(text, re.DOTALL).fullmatch
        except (re.error, FutureWarning) as error:
            raise self._wrong(str(error)) from None
        return lambda after: self._add("one", [after], test)

    def _repeated(self, build: _Build) -> _Build:
        while (found := _REPEATED.match(self._text, self._at)) is not None:
            self._at = found.end()
            mark, low, comma, high = found.groups()
            least = int(low) if low else int(mark == "+")
            most = (1 if mark == "?" else None) if mark else (int(high) if high else None) if comma else least
            if most is not None and most < least:
                raise self._wrong("the least count is above the most")
            build = self._times(build, least, most)
        return build

    def _times(self, build: _Build, least: int, most: int | None) -> _Build:
        def built(after: int) -> int:
            first = after
            if most is None:
                first = self._add("any", [after])
                self._states[first].following.append(build(first))
            for _ in range(0 if most is None else most - least):
                first = self._add("any", [after, build(first)])
            for _ in range(least):
                self._note()
                first = build(first)
            return first

        return built

    def _add(self, kind: str, following: list[int], test: Callable[[str], Any] | None = None) -> int:
        self._note()
        self._states.append(_State(kind, test, following))
        return len(self._states) - 1

    def _note(self) -> None:
        self._count += 1
        if self._count > _MOST_STATES:
            raise self._wrong("its repetitions are too many")

    def _takes(self, mark: str) -> bool:
        is_there = self._text.startswith(mark, self._at)
        self._at += len(mark) if is_there else 0
        return is_there

    def _wrong(self, why: str) -> InputError:
        return InputError(f"{self._text!r} is not a regular expression that a filter can have: {why}")
