"""The integral part of gz-sim's joint controllers: the numbers that gz-math's PID gives for the same errors."""

import numpy as np
import pytest
from controller_parameters import parameters_of
from device_harness import Running, setup_of

from drake_twin import messages
from drake_twin.controllers.joint_pid_controller import JointPidController
from drake_twin.description.gazebo_drive import JOINT_PID
from drake_twin.errors import CommandError


def pid(state=(0.0, 0.0, 0.0, 0.0), **given):
    parameters = parameters_of(JOINT_PID, **{"joints": ["finger", "thumb"], "interface": "position"} | given)
    return Running(JointPidController(setup_of(JointPidController, parameters)), state=np.array(state), commands=None)


def efforts(run, count):
    """The added efforts of the first joint after each of some updates."""
    found = []
    for step in range(1, count + 1):
        run.advance(0.01 * step)
        found.append(run.commands()[2])
    return found


def test_nothing_is_written_before_a_command():
    run = pid(i_gain=2.0)
    run.advance(0.05)
    assert np.isnan(run.commands()).all()


def test_it_adds_up_the_error_times_the_gain_and_the_time():
    run = pid(state=[0.1, -0.3, 0, 0], i_gain=2.0)
    run.send("commands", messages.Numbers((0.6, -0.1)))
    assert efforts(run, 3) == pytest.approx([2 * 0.5 * 0.01, 2 * 0.5 * 0.02, 2 * 0.5 * 0.03])
    assert run.commands() == pytest.approx([0.6, -0.1, 0.03, 2 * 0.2 * 0.03])


def test_a_command_acts_at_once_and_time_before_it_does_not_count():
    run = pid(state=[0.1, 0, 0, 0], i_gain=2.0)
    run.advance(0.995)
    run.send("commands", messages.Numbers((0.6, 0.0)))
    assert run.commands() == [0.6, 0.0, 0.0, 0.0]
    run.advance(1.0)
    assert run.commands()[2] == pytest.approx(2 * 0.5 * 0.01)


def test_the_error_of_a_velocity_is_that_of_the_velocity():
    run = pid(state=[9, 9, 0.1, 0.2], interface="velocity", i_gain=1.0)
    run.send("commands", messages.Numbers((1.1, 0.2)))
    run.advance(0.01)
    assert run.commands() == pytest.approx([1.1, 0.2, 0.01, 0.0])


@pytest.mark.parametrize(
    ("limits", "expected"),
    [  # the term has the sign of measured minus commanded, and is subtracted
        ({"i_min": -0.015}, [0.01, 0.015, 0.015]),
        ({"i_max": -0.012, "i_min": -1.0}, [0.012, 0.022, 0.032]),
        ({"i_max": -1.0, "i_min": 1.0}, [0.01, 0.02, 0.03]),  # no limits
        ({"i_min": -0.015, "cmd_offset": 0.5}, [0.51, 0.515, 0.515]),
    ],
)
def test_the_term_is_clamped_after_each_update(limits, expected):
    run = pid(state=[0.1, 0, 0, 0], i_gain=2.0, **limits)
    run.send("commands", messages.Numbers((0.6, 0.0)))
    assert efforts(run, 3) == pytest.approx(expected)


def test_a_command_for_another_number_of_joints_is_refused():
    with pytest.raises(CommandError, match="the command has 1 elements"):
        pid().send("commands", messages.Numbers((0.6,)))
