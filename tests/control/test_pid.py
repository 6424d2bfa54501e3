import math

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from drake_twin.control.pid import ANTIWINDUP_STRATEGIES, Pid, PidGains, PidMemory
from drake_twin.errors import InputError


def run(gains, errors, dt=0.01, error_dots=None):
    pid, memory, commands = Pid(gains), PidMemory(), []
    for error, error_dot in zip(errors, error_dots or [0.0] * len(errors), strict=True):
        command, memory = pid.compute(error, error_dot, dt, memory)
        commands.append(command)
    return commands, memory


def test_the_three_terms_add_up():
    command, memory = Pid(PidGains(p=2.0, i=10.0, d=0.5)).compute(0.3, -0.4, 0.1, PidMemory(integral=1.0))
    assert command == pytest.approx(2.0 * 0.3 + (1.0 + 10.0 * 0.3 * 0.1) + 0.5 * -0.4, abs=1e-15)
    assert memory.integral == pytest.approx(1.3, abs=1e-15)


@pytest.mark.parametrize("strategy", ANTIWINDUP_STRATEGIES)
def test_the_integral_term_is_the_integral_of_the_error(strategy):
    times = np.arange(0.0, 1.0, 1e-4)
    errors = np.sin(3.0 * times)
    gains = PidGains(p=1.0, i=4.0, antiwindup_strategy=strategy)
    _, memory = run(gains, errors.tolist(), dt=1e-4)
    assert memory.integral == pytest.approx(4.0 * cumulative_trapezoid(errors, times)[-1], abs=1e-3)


def test_legacy_integrates_before_the_command_and_the_others_after_it():
    first = {
        strategy: run(PidGains(p=1.0, i=10.0, antiwindup_strategy=strategy), [1.0])[0][0]
        for strategy in ANTIWINDUP_STRATEGIES
    }
    assert first.pop("legacy") == pytest.approx(1.1)
    assert set(first.values()) == {1.0}


def test_the_derivative_is_taken_from_the_last_error_when_none_is_given():
    commands, _ = run(PidGains(d=2.0), [0.1, 0.3, 0.2], dt=0.1, error_dots=[None] * 3)
    assert commands == pytest.approx([2.0, 4.0, -2.0])


def test_the_command_is_clamped():
    commands, _ = run(PidGains(p=10.0, u_clamp_max=3.0, u_clamp_min=-1.0), [1.0, -1.0, 0.2])
    assert commands == [3.0, -1.0, 2.0]


def test_the_integral_term_is_clamped():
    commands, memory = run(PidGains(i=100.0, i_clamp_max=0.5, i_clamp_min=-0.2), [1.0] * 10 + [-1.0])
    assert commands[9] == 0.5
    assert memory.integral == -0.2


def test_conditional_integration_stands_still_while_the_command_is_clamped():
    gains = PidGains(p=10.0, i=1.0, u_clamp_max=1.0, antiwindup_strategy="conditional_integration")
    _, memory = run(gains, [1.0] * 100)
    assert memory.integral == 0.0
    _, memory = run(gains, [0.05] * 100)
    assert memory.integral == pytest.approx(0.05)


def test_back_calculation_draws_the_integral_back_to_the_limit():
    # At rest i·e = (wanted − clamped)/T, so that the command wants i·e·T = √(d·i)·e more than it may have.
    gains = PidGains(p=1.0, i=4.0, d=1.0, u_clamp_max=2.0, antiwindup_strategy="back_calculation")
    _, memory = run(gains, [3.0] * 5000)
    assert memory.integral == pytest.approx(2.0 + math.sqrt(4.0) * 3.0 - 3.0, abs=1e-9)


def test_an_error_within_the_deadband_is_not_integrated():
    _, memory = run(PidGains(i=1.0, error_deadband=0.1), [0.1, 0.1, 0.05])
    assert memory.integral == 0.0


def test_no_time_repeats_the_last_command():
    pid = Pid(PidGains(p=1.0))
    _, memory = pid.compute(0.5, 0.0, 0.1, PidMemory())
    assert pid.compute(9.0, 0.0, 0.0, memory) == (0.5, memory)


@pytest.mark.parametrize(("error", "error_dot"), [(math.nan, 0.0), (0.0, math.inf), (math.nan, None)])
def test_an_error_that_is_no_number_gives_no_command_and_spoils_nothing(error, error_dot):
    pid = Pid(PidGains(p=1.0, i=1.0, d=1.0))
    _, before = pid.compute(0.5, 0.0, 0.1, PidMemory())
    command, memory = pid.compute(error, error_dot, 0.1, before)
    assert math.isnan(command)
    assert memory.integral == before.integral
    assert pid.compute(0.0, 0.0, 0.1, memory)[0] == before.integral


@pytest.mark.parametrize(
    ("gains", "text"),
    [
        (PidGains(u_clamp_min=1.0, u_clamp_max=1.0), "u_clamp_min 1 is not below u_clamp_max 1"),
        (PidGains(i_clamp_min=0.1), "i_clamp_min 0.1 and i_clamp_max inf do not have zero between them"),
        (PidGains(antiwindup_strategy="non"), "Did you mean 'none'"),
        (PidGains(i=1.0, antiwindup_strategy="back_calculation"), "needs a tracking_time_constant above zero"),
    ],
)
def test_gains_that_make_no_sense_are_refused(gains, text):
    with pytest.raises(InputError, match=text):
        Pid(gains)


def test_time_that_runs_backwards_is_refused():
    with pytest.raises(ValueError, match="time runs backwards"):
        Pid(PidGains()).compute(0.0, 0.0, -0.1, PidMemory())
