import numpy as np
import pytest

from drake_twin.errors import InputError
from drake_twin.scenario import Command
from drake_twin.twin.schedule import ScheduledCommand, meeting_step, step_at


@pytest.mark.parametrize("step", [0.001, 0.0007, 0.005, 0.01, 1 / 3])
def test_a_time_that_is_a_step_but_for_rounding_is_that_step(step):
    for k in range(2000):
        for time in (k * step, np.nextafter(k * step, 1e9), np.nextafter(k * step, -1e9), float(f"{k * step:.12g}")):
            assert step_at(time, step) == k


def test_a_time_between_two_steps_is_met_by_the_later_one():
    assert [step_at(time, 0.01) for time in (0.0, 1e-5, 0.005, 0.00999, 0.0101, 0.3)] == [0, 1, 1, 1, 2, 30]


@pytest.mark.parametrize(
    ("step", "length", "other", "expected"),
    [
        (0, 0.001, 0.01, 0),
        (1, 0.001, 0.01, 10),  # 10 ms is the next multiple of both
        (10, 0.001, 0.01, 10),
        (11, 0.001, 0.01, 20),
        (3, 0.004, 0.006, 3),  # 12 ms
        (4, 0.004, 0.006, 6),  # 24 ms
        (7, 0.01, 0.001, 7),
        (1, 0.001, 1000.0, 1_000_000),
    ],
)
def test_two_lengths_meet_at_their_next_common_multiple(step, length, other, expected):
    assert meeting_step(step, length, other) == expected


def test_lengths_that_do_not_meet_within_an_hour_are_refused():
    assert meeting_step(1, 0.001, 3600.0) == 3_600_000
    with pytest.raises(InputError, match=r"a step of 3601 s never meets the present one of 0\.001 s"):
        meeting_step(1, 0.001, 3601.0)
    with pytest.raises(InputError, match="never meets"):
        meeting_step(1, 0.001, 0.0010000001)


def test_a_command_comes_once_and_a_periodic_one_again_each_period():
    once, again = ScheduledCommand(Command("/t", (1.0,), 0.5)), ScheduledCommand(Command("/t", (1.0,), 0.5, 0.2))
    steps = []
    for _ in range(3):
        steps.append((once.due_step(0.1), again.due_step(0.1)))
        once.pass_step()
        again.pass_step()
    assert steps == [(5, 5), (np.inf, 7), (np.inf, 9)]
