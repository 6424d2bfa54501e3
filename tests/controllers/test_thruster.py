"""gz-sim's Thruster on its own: commands, its deadband, its speeds, and what a file may say."""

from math import inf, nan, sqrt

import numpy as np
import pytest
from controller_parameters import parameters_of
from device_harness import Running, setup_of
from waters import propelled, thruster, twin_of

from drake_twin.control.propeller import Propeller
from drake_twin.controllers.thruster import Thruster
from drake_twin.description.gazebo_drive import THRUSTER
from drake_twin.errors import CommandError, InputError
from drake_twin.messages.interface_types import make

OWN = {"joint_name": "thumb", "thrust_coefficient": 0.02, "propeller_diameter": 0.1}
SCALE = 1000.0 * 0.02 * 0.1**4


def running(**parameters):
    values = parameters_of(THRUSTER, **OWN | parameters)
    command = "cmd_vel" if values.use_angvel_cmd else "cmd_thrust"
    ports = {"state": np.zeros(4), command: None, "enable_deadband": None}
    return Running(Thruster(setup_of(Thruster, values)), **ports)


def number(value):
    return make("std_msgs/msg/Float64", {"data": value})


def thrust(run):
    (value,) = run.controller.GetOutputPort("signals").Eval(run.context)
    return value


def test_nothing_pushes_before_the_first_command():
    run = running()
    assert (thrust(run), run.commands()) == (0.0, [0.0])


@pytest.mark.parametrize(("asked", "given"), [(3.0, 3.0), (30.0, 20.0), (-30.0, -5.0)])
def test_a_command_is_clamped_and_turns_the_propeller(asked, given):
    run = running(max_thrust_cmd=20.0, min_thrust_cmd=-5.0)
    run.send("cmd_thrust", number(asked))
    assert thrust(run) == given
    assert run.commands() == pytest.approx([np.sign(given) * sqrt(abs(given) / SCALE)])


def test_a_speed_is_clamped_and_has_its_thrust():
    run = running(use_angvel_cmd=True, max_thrust_cmd=20.0)
    run.send("cmd_vel", number(100.0))
    assert thrust(run) == pytest.approx(SCALE * 400)
    assert run.commands() == pytest.approx([20.0])


def test_a_thrust_in_the_deadband_is_none_unless_a_message_switches_that_off():
    run = running(deadband=2.0)
    run.send("cmd_thrust", number(-1.9))
    assert (thrust(run), run.commands()) == (0.0, [0.0])
    run.send("enable_deadband", make("std_msgs/msg/Bool", {"data": False}))
    assert thrust(run) == -1.9
    run.send("enable_deadband", make("std_msgs/msg/Bool", {"data": True}))
    assert thrust(run) == 0.0
    run.send("cmd_thrust", number(2.0))
    assert thrust(run) == 2.0


@pytest.mark.parametrize("value", [nan, inf])
def test_commands_that_are_refused(value):
    run = running()
    with pytest.raises(CommandError, match=r"cmd_thrust: .* is not finite"):
        run.send("cmd_thrust", number(value))


@pytest.mark.parametrize("coefficient", [0.02, -0.02])
@pytest.mark.parametrize("velocity", [0.0, 1.5])
@pytest.mark.parametrize("asked", [8.0, -8.0, 0.0])
def test_the_speed_is_that_which_has_the_thrust(coefficient, velocity, asked):
    propeller = Propeller(0.1, coefficient, 0.01)
    speed = propeller.speed(asked, velocity)
    assert propeller.thrust(speed, velocity) == pytest.approx(asked)
    assert np.sign(speed) == np.sign(asked * coefficient)


@pytest.mark.parametrize(
    ("parameters", "says"),
    [
        ({"fluid_density": 0.0}, "fluid_density is 0, and has to be above zero"),
        ({"propeller_diameter": -0.1}, "propeller_diameter is -0.1, and has to be above zero"),
        ({"thrust_coefficient": 0.0, "alpha_1": 0.0}, "alpha_1 is 0, so that nothing is thrust"),
        ({"max_thrust_cmd": -2000.0}, "max_thrust_cmd is less than min_thrust_cmd"),
    ],
)
def test_parameters_that_are_refused(parameters, says):
    with pytest.raises(InputError, match=says):
        running(**parameters)


def vehicle(folder, plugin):
    return twin_of(folder, "", 0.01, {"auv": (propelled((1.0, 0.4, 0.3), f"\n\n{plugin}"), (0, 0, 0))})


@pytest.mark.parametrize(
    ("elements", "says"),
    [
        ({"propeller_diameter": 0}, "<propeller_diameter> is 0, and has to be above zero"),
        ({"fluid_density": -1}, "<fluid_density> is -1, and has to be above zero"),
        ({"thrust_coefficient": 0}, "<thrust_coefficient> is 0, so that nothing is thrust"),
        ({"thrust_coefficient": None, "alpha_1": 0}, "<alpha_1> is 0, so that nothing is thrust"),
        ({"max_thrust_cmd": "full"}, "<max_thrust_cmd> is 'full', which is not"),
        ({"velocity_control": 2}, "<velocity_control> is '2', which is neither true nor false"),
    ],
    ids=lambda value: next(reversed(value)) if isinstance(value, dict) else "",
)
def test_values_that_are_refused_with_file_and_line(tmp_path, elements, says):
    with pytest.raises(InputError) as refusal:
        vehicle(tmp_path, thruster(**elements))
    assert str(refusal.value).startswith(f"{tmp_path / 'auv.sdf'}:7: ")
    assert says in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("plugin", "says"),
    [
        (thruster("mast"), "the robot has no movable joint 'mast'"),
        (thruster(p_gain=-1), "<p_gain> is -1: the propeller would run away"),
        (thruster(max_thrust_cmd=-5000), "<max_thrust_cmd> is less than <min_thrust_cmd>: commands are within 1000"),
        (thruster(alpha_1=1), "<alpha_1> and <alpha_2> change nothing beside <thrust_coefficient>"),
        (thruster(battery_name="b"), "<battery_name> of Gazebo plugin thruster"),
    ],
    ids=("joint", "gain", "range", "alpha", "battery"),
)
def test_what_is_not_done_is_said(tmp_path, plugin, says):
    assert says in "\n".join(str(item) for item in vehicle(tmp_path, plugin).findings)
