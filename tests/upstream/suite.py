"""Upstream's assertions as data: the lines of a gtest file, what each expects, and what the twin does instead of it."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import pytest

from upstream.differences import DELIBERATE

Play = Callable[[], Iterable[tuple[int, Any]]]


@dataclass(frozen=True)
class Is:
    """A value of which upstream asserts a property and not a number; equal to every value that has it."""

    text: str
    holds: Callable[[Any], bool]

    def __eq__(self, other: object) -> bool:
        return bool(self.holds(other))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return self.text


def above(bound: float) -> Is:
    return Is(f"> {bound:g}", lambda value: value > bound)


def below(bound: float) -> Is:
    return Is(f"< {bound:g}", lambda value: value < bound)


def near(value: float, tolerance: float) -> Any:
    return pytest.approx(value, abs=tolerance)


@dataclass(frozen=True)
class Scenario:
    """One upstream TEST: the expected value of each asserting line, and a generator of (line, the twin's value)."""

    file: str
    name: str
    expected: Mapping[int, Any]
    play: Play

    def check(self) -> None:
        """Compare every line."""
        seen = dict(self.play())
        assert seen.keys() == self.expected.keys(), f"lines {sorted(seen.keys() ^ self.expected.keys())}"
        wrong = []
        for line, upstream in self.expected.items():
            difference = DELIBERATE.get((self.file, line))
            wanted = upstream if difference is None else difference.twin
            if not _equal(wanted, seen[line]):
                wrong.append(f"{self.file}:{line}: {seen[line]!r} instead of {wanted!r}")
            elif difference is not None and _equal(upstream, seen[line]):
                wrong.append(f"{self.file}:{line}: listed as a difference, but equal to upstream's {upstream!r}")
        assert not wrong, "\n".join(wrong)


class Suite:
    """The assertions of one upstream test file.

    Args:
        file: Its path in its repository, e.g. "control_toolbox/test/pid_tests.cpp".
    """

    def __init__(self, file: str):
        self.file = file
        self.scenarios: list[Scenario] = []

    @property
    def lines(self) -> list[int]:
        return [line for scenario in self.scenarios for line in scenario.expected]

    def scenario(self, expected: Mapping[int, Any]) -> Callable[[Play], Play]:
        """Add a scenario; the generator yields (line, the twin's value) for each line of ``expected``."""

        def add(play: Play) -> Play:
            twice = set(expected) & set(self.lines)
            assert not twice, f"{self.file}: lines {sorted(twice)} are counted twice"
            self.scenarios.append(Scenario(self.file, play.__name__, expected, play))
            return play

        return add

    def table(self, rows: Iterable[tuple[Any, ...]]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
        """Add a scenario of rows (line, inputs…, expected), each the result of one call with its inputs."""
        rows = tuple(rows)

        def add(function: Callable[..., Any]) -> Callable[..., Any]:
            def play() -> Iterator[tuple[int, Any]]:
                for line, *inputs, _ in rows:
                    yield line, function(*inputs)

            play.__name__ = function.__name__
            self.scenario({row[0]: row[-1] for row in rows})(play)
            return function

        return add

    def test(self) -> Callable[..., None]:
        """Return the test function of all scenarios."""

        @pytest.mark.parametrize("scenario", self.scenarios, ids=lambda scenario: scenario.name)
        def test_holds_against_upstream(scenario: Scenario) -> None:
            scenario.check()

        return test_holds_against_upstream


def refuses(function: Callable[[], Any], *errors: type[Exception]) -> bool:
    """Tell whether a call raises; upstream's EXPECT_THROW is True, EXPECT_NO_THROW False."""
    try:
        function()
    except errors:
        return True
    return False


def _equal(expected: Any, seen: Any) -> bool:
    if isinstance(expected, float | list | tuple) and not isinstance(expected, bool):
        try:
            return bool(seen == pytest.approx(expected, rel=1e-12, abs=1e-9, nan_ok=True))
        except TypeError:
            return bool(seen == expected)
    return bool(expected == seen)
