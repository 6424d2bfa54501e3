"""gz-sim's multicopter systems on their own: what a message makes of the rotors' speeds, and what a file may say."""

from math import exp, inf, nan

import numpy as np
import pytest
from controller_parameters import parameters_of
from device_harness import ROBOT, Running, setup_of
from multicopters import motor, quadcopter

from drake_twin import TwinBuilder, messages
from drake_twin.control.lee_velocity import ControlledRotor, LeeGains, LeeVelocity
from drake_twin.controllers.multicopter import Multicopter
from drake_twin.description.gazebo_drive import MULTICOPTER
from drake_twin.errors import CommandError, InputError

ROTORS = {
    "joints": ["finger", "thumb"],
    "links": ["finger_link", "thumb_link"],
    "actuator_numbers": [1, 0],
    "turning_directions": [1, -1],
    "motor_constants": [1e-5, 1e-5],
    "moment_constants": [0.02, 0.02],
    "max_rot_velocities": [500.0, 800.0],
    "time_constants_up": [0.1, 0.1],
    "time_constants_down": [0.2, 0.2],
    "rotor_drag_coefficients": [0.0, 0.0],
    "rolling_moment_coefficients": [0.0, 0.0],
    "rotor_velocity_slowdowns": [10.0, 1.0],
}


def rotors():
    parameters = parameters_of(MULTICOPTER, **ROTORS)
    return Running(Multicopter(setup_of(Multicopter, parameters)), motor_speed=None)


def actuators(*values):
    return messages.message("actuator_msgs/msg/Actuators", {"velocity": list(values)})


def signals(run):
    """Of each rotor: since when, from which speed, to which, and the lag."""
    rows = run.controller.GetOutputPort("signals").Eval(run.context).reshape(-1, 4).tolist()
    return [[since, target + gap, target, -1 / rate] for since, target, gap, rate in rows]


def test_joints_turn_as_their_numbers_and_directions_say():
    run = rotors()
    assert run.commands() == [0.0, 0.0]
    run.send("motor_speed", actuators(300.0, 200.0))
    assert run.commands() == pytest.approx([20.0, -300.0])


def test_speeds_start_from_those_that_the_rotors_have():
    run = rotors()
    run.send("motor_speed", actuators(100.0, 600.0))  # the first rotor's largest is 500
    assert signals(run) == [[0.0, 0.0, 500.0, 0.1], [0.0, 0.0, 100.0, 0.1]]
    run.advance(0.1)
    run.send("motor_speed", actuators(0.0, 500.0))
    risen = 1 - exp(-1)
    assert signals(run)[0] == pytest.approx([0.1, 500 * risen, 500.0, 0.1])
    assert signals(run)[1] == pytest.approx([0.1, 100 * risen, 0.0, 0.2])
    run.advance(0.3)
    run.send("motor_speed", actuators(0.0, 0.0))
    assert signals(run)[1][1] == pytest.approx(100 * risen * exp(-1))  # with the lag of a speed that falls


@pytest.mark.parametrize("values", [(1.0,), (1.0, nan), (inf, 1.0)])
def test_messages_that_are_refused(values):
    run = rotors()
    with pytest.raises(CommandError, match="motor_speed: "):
        run.send("motor_speed", actuators(*values))
    assert run.commands() == [0.0, 0.0]


def test_nothing_turns_while_it_is_inactive():
    run = rotors()
    run.send("motor_speed", actuators(100.0, 100.0))
    run.controller.deactivate(run.context)
    assert all(row[1:3] == [0.0, 0.0] for row in signals(run))


def built(folder, text):
    file = folder / "x3.sdf"
    file.write_text(text)
    return TwinBuilder().robot("uav", file).build()


@pytest.mark.parametrize(
    ("elements", "says"),
    [
        ({"timeConstantUp": 0}, "<timeConstantUp> is 0, and has to be above zero"),
        ({"motorConstant": -1e-6}, "<motorConstant> is -1e-06, and has to be zero or more"),
        ({"maxRotVelocity": "nan"}, "<maxRotVelocity> is 'nan', which is"),
        ({"turningDirection": "left"}, "<turningDirection> is 'left', which is neither 'cw' nor 'ccw'"),
        ({"actuator_number": 1.5}, "<actuator_number> is 1.5, which is not a whole number from 0"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_values_that_are_refused_with_file_and_line(tmp_path, elements, says):
    text = quadcopter(plugins=f"\n{motor(0, 'cw', **elements)}")
    with pytest.raises(InputError) as refusal:
        built(tmp_path, text)
    assert str(refusal.value).startswith(f"{tmp_path / 'x3.sdf'}:2: ")
    assert says in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("elements", "says"),
    [
        ({"jointName": "rotor_9_joint"}, "the robot has no movable joint 'rotor_9_joint'"),
        ({"linkName": "rotor_9"}, "the robot has no link 'rotor_9'"),
        ({"motorType": "force"}, "<motorType> is 'force', and gz-sim drives 'velocity' alone"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_what_does_nothing_in_gazebo_is_said(tmp_path, elements, says):
    twin = built(tmp_path, quadcopter(plugins=motor(0, "cw", **elements)))
    (finding,) = (str(item) for item in twin.findings if "multicopter" in str(item))
    assert says in finding


@pytest.mark.parametrize("more", [{"links": ["gone", "thumb_link"]}, {"controls_velocity": True, "com_link": "gone"}])
def test_a_link_that_the_robot_does_not_have_is_a_problem(more):
    assert Multicopter.problem(parameters_of(MULTICOPTER, **ROTORS | more), ROBOT) == "the robot has no link 'gone'"
    assert Multicopter.problem(parameters_of(MULTICOPTER, **ROTORS), ROBOT) is None


def test_rotors_with_topics_of_their_own_are_controllers_of_their_own(tmp_path):
    plugins = "".join(motor(number, "cw", commandSubTopic=f"motor_{number // 2}") for number in range(4))
    twin = built(tmp_path, quadcopter(plugins=plugins))
    topics = twin.graph.topics()
    assert {"/uav/motor_0", "/uav/motor_1"} <= topics.keys()


def test_rotors_that_cannot_turn_a_body_cannot_control_it():
    rotor = ControlledRotor(0.0, 0.2, 1e-5, 0.02, 1.0)
    gains = LeeGains((1, 1, 1), (1, 1, 1), (1, 1, 1), (1, 1, 1))
    with pytest.raises(ValueError, match="cannot turn the body about each axis"):
        LeeVelocity([rotor] * 4, gains, 1.0, np.eye(3), np.array([0, 0, -9.81]))
