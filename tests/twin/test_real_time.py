"""What `Twin.run` calls each frame, and what ends it."""

import numpy as np
import pytest
from conftest import rovers


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
