"""What is said of building a twin that takes long."""

import contextlib
import io
import itertools

import pytest
from waiting import until

from drake_twin.cli import build_line
from drake_twin.progress import tell


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize(
    ("stream", "line"), [(io.StringIO, "reading big.stl …\n"), (Terminal, "\r\033[Kreading big.stl …")]
)
def test_a_step_that_takes_long_is_said_while_it_lasts(monkeypatch, stream, line):
    said = stream()
    monkeypatch.setattr("sys.stderr", said)
    monkeypatch.setattr(build_line, "_LONG", 0.01)
    monkeypatch.setattr(build_line, "_PERIOD", 0.01)
    with build_line.build_line(()):
        tell("reading big.stl")
        with contextlib.redirect_stderr(io.StringIO()) as xacros:
            until(lambda: line in said.getvalue())
        assert xacros.getvalue() == ""
    assert said.getvalue().count("reading") == 1


def test_what_is_short_says_nothing(monkeypatch):
    said = io.StringIO()
    monkeypatch.setattr("sys.stderr", said)
    with build_line.build_line(()):
        tell("reading small.stl")
    assert said.getvalue() == ""


def test_of_many_short_steps_one_is_said_after_a_silence(monkeypatch):
    said = io.StringIO()
    monkeypatch.setattr("sys.stderr", said)
    monkeypatch.setattr(build_line, "_PERIOD", 0.01)
    monkeypatch.setattr(build_line, "_SILENCE", 0.01)
    numbers = itertools.count()
    with build_line.build_line(()):
        until(lambda: tell(f"reading robot_{next(numbers)}") or "reading robot_" in said.getvalue())
