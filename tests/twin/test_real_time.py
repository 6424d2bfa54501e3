"""What `Twin.run` calls each frame, and what ends it."""

from types import SimpleNamespace

import numpy as np
import pytest
from conftest import rovers

from drake_twin.twin import real_time


@pytest.fixture
def twin():
    return rovers(1, time_step=0.01).build()


@pytest.mark.parametrize("answer", [None, True, 0, "", np.True_])
def test_a_run_continues_unless_each_frame_returns_false(twin, answer):
    calls = []

    def each_frame():
        calls.append(twin.time)
        return answer

    twin.run(0.1, each_frame=each_frame)
    assert twin.time == pytest.approx(0.1)
    assert len(calls) > 2


@pytest.mark.parametrize("answer", [False, np.False_])
def test_a_run_ends_when_each_frame_returns_false(twin, answer):
    twin.run(each_frame=lambda: answer)
    assert twin.time == 0


def test_frame_callbacks_are_called_before_each_frame_and_once_more_at_the_end(twin):
    calls = []
    twin.frames.callbacks.append(lambda: calls.append(("callback", twin.time)))
    twin.run(0.1, each_frame=lambda: calls.append(("each_frame", twin.time)))
    names = [name for name, _ in calls]
    assert names == ["callback", "each_frame"] * (len(calls) // 2) + ["callback"]
    assert calls[-1] == ("callback", pytest.approx(0.1))


def test_a_frame_callback_may_reset_the_twin_at_the_end_and_end_its_own_calls(twin):
    resets = []

    def reset_once():
        if twin.time >= 0.1 - 1e-9:
            twin.frames.callbacks.remove(reset_once)
            twin.reset()
            resets.append(twin.time)

    twin.frames.callbacks.append(reset_once)
    twin.run(0.1, as_fast_as_possible=True)
    assert resets == [0]
    assert twin.time == pytest.approx(0.1)


def test_frames_are_running_during_a_run_only_also_after_an_error(twin):
    def fail():
        assert twin.frames.are_running
        raise ValueError

    with pytest.raises(ValueError):
        twin.run(each_frame=fail)
    assert not twin.frames.are_running


class SlowClock:
    """A wall clock that each step of a twin takes so long on (s), and nothing else."""

    def __init__(self, twin, monkeypatch, step):
        self.now, advance = 0.0, twin.advance_to

        def advance_to(time):
            self.now += step(round((time - twin.time) / twin.clock.time_step))
            return advance(time)

        def sleep(seconds):
            self.now += seconds

        monkeypatch.setattr(twin, "advance_to", advance_to)
        monkeypatch.setattr(real_time, "wall_clock", SimpleNamespace(perf_counter=lambda: self.now, sleep=sleep))


def frames_of(twin, clock, until):
    """The wall time and the simulation time of each frame of a run (s)."""
    found = []
    twin.run(until, each_frame=lambda: found.append((clock.now, twin.time)))
    return np.array(found)


def test_a_twin_that_is_slow_has_shorter_frames_and_not_fewer(monkeypatch):
    twin = rovers(1, time_step=0.001).build()
    clock = SlowClock(twin, monkeypatch, lambda steps: 0.01 * steps)  # a tenth of real time
    wall = np.diff(frames_of(twin, clock, 0.3)[:, 0])
    assert max(wall[1:]) <= 2 / 30 + 0.01  # two frames of a fast one, and a step
    assert twin.frames.missed == pytest.approx(clock.now - 0.3, abs=0.3)


def test_a_step_that_takes_more_than_a_frame_is_one_a_frame(monkeypatch):
    twin = rovers(1, time_step=0.01).build()
    clock = SlowClock(twin, monkeypatch, lambda steps: 0.5 * steps)
    simulated = np.diff(frames_of(twin, clock, 0.2)[:, 1])
    assert simulated[2:] == pytest.approx(0.01)


def test_one_frame_that_is_late_is_made_up_for(monkeypatch):
    twin = rovers(1, time_step=0.001).build()
    taken = iter([0.0] * 5 + [0.2] + [0.0] * 1000)
    clock = SlowClock(twin, monkeypatch, lambda steps: next(taken))
    found = frames_of(twin, clock, 1.0)
    assert found[-1, 0] - found[-1, 1] < 0.05
    assert twin.frames.missed == pytest.approx(0.0, abs=1e-9)
