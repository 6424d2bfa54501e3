"""The line of a sweep without a terminal: the rate of this run's episodes, and the time that the rest takes at it."""

import pytest

from drake_twin.sweeps.progress_line import ProgressLine


@pytest.fixture
def clock(monkeypatch):
    """The time that passes, in a list of one number."""
    now = [100.0]
    monkeypatch.setattr("drake_twin.sweeps.progress_line.time.monotonic", lambda: now[0])
    return now


def test_the_rate_is_of_what_this_run_has_done(clock, capsys):
    with ProgressLine(100, done=40) as line:
        for outcome in ("done", "error", "fell"):
            clock[0] += 4.0
            line.show({"outcome": outcome})
        assert capsys.readouterr().err == "43 of 100 episodes, 0.25/s, 228 s left, 1 failed\n"  # 57 at 4 s each
        for _ in range(4):
            clock[0] += 2.0
            line.show({"outcome": "done"})
        assert capsys.readouterr().err == ""  # a line in ten seconds
        clock[0] += 4.0
        line.show({"outcome": "done"})
        assert capsys.readouterr().err == "48 of 100 episodes, 0.333/s, 156 s left, 1 failed\n"


def test_nothing_fails_and_nothing_is_said_of_it(clock, capsys):
    line = ProgressLine(2, done=0)
    clock[0] += 20.0
    line.show({"outcome": "done"})
    assert capsys.readouterr().err == "1 of 2 episodes, 0.05/s, 20 s left\n"
