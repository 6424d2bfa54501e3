from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RevoluteJoint, SpatialInertia, UnitInertia

from drake_twin.systems.joint_servo import JointServo, ServoAssignment

NAN = np.nan


def make_dut(assignment, controllers, lower=None, upper=None):
    size = len(assignment.modes)
    free = np.full((3, size), np.inf)
    return JointServo(controllers, assignment, -free if lower is None else lower, free if upper is None else upper)


def evaluate(dut, **commands):
    context = dut.CreateDefaultContext()
    for controller, values in commands.items():
        dut.get_controller_input_port(controller).FixValue(context, values)
    return (
        dut.get_desired_state_output_port().Eval(context).tolist(),
        dut.get_actuation_output_port().Eval(context).tolist(),
    )


# Two wheels (actuators 2 and 0) and an arm's joint (1): the values are wheel, wheel, arm position, arm velocity, force.
WHEELS_AND_ARM = ServoAssignment(
    ("velocity", "position", "velocity"), (0.0, 0.3, 0.0), (-1, 2, -1), (1, 3, 0), (-1, 4, -1)
)
SIZES = {"wheels": 2, "arm": 3}


def test_commands_land_on_the_actuators_of_their_controllers_joints():
    desired, efforts = evaluate(make_dut(WHEELS_AND_ARM, SIZES), wheels=[5.0, 6.0], arm=[0.7, 0.1, 9.0])
    assert desired == [0.0, 0.7, 0.0, 6.0, 0.1, 5.0]
    assert efforts == [0, 9, 0]


def test_before_the_first_command_wheels_stand_positions_are_held_and_no_effort_is_added():
    desired, efforts = evaluate(make_dut(WHEELS_AND_ARM, SIZES), wheels=[NAN, NAN], arm=[NAN] * 3)
    assert desired == [0.0, 0.3, 0.0, 0.0, 0.0, 0.0]
    assert efforts == [0, 0, 0]


def test_a_robot_without_controllers_is_held_where_it_started():
    nothing = ServoAssignment(("hold", "hold"), (0.3, -0.4), (-1, -1), (-1, -1), (-1, -1))
    assert evaluate(make_dut(nothing, {})) == ([0.3, -0.4, 0.0, 0.0], [0, 0])


@pytest.mark.parametrize(
    ("wheels", "arm", "moves"),
    [
        ([NAN, NAN], [NAN] * 3, 0),
        ([0.0, 0.0], [0.7, 0.0, 0.0], 0),
        ([0.0, 0.1], [NAN] * 3, 1),
        ([NAN, NAN], [0.7, -0.1, NAN], 1),
        ([0.0, 0.0], [NAN, NAN, -2.0], 1),
    ],
)
def test_motion_is_commanded_by_velocities_and_efforts(wheels, arm, moves):
    dut = make_dut(WHEELS_AND_ARM, SIZES)
    context = dut.CreateDefaultContext()
    dut.get_controller_input_port("wheels").FixValue(context, wheels)
    dut.get_controller_input_port("arm").FixValue(context, arm)
    assert dut.get_commanded_motion_output_port().Eval(context).tolist() == [moves]


def test_commands_beyond_the_limits_are_clamped_to_them():
    limit = np.array([[9.0, 0.5, 9.0], [2.0, 9.0, 3.0], [1.0, 4.0, 1.0]])
    dut = make_dut(WHEELS_AND_ARM, SIZES, -limit, limit)
    desired, efforts = evaluate(dut, wheels=[5.0, -6.0], arm=[0.4, 0.1, -9.0])
    assert desired == [0.0, 0.4, 0.0, -2.0, 0.1, 3.0]
    assert efforts == [0, -4, 0]


def test_the_first_command_of_each_interface_that_is_cut_is_logged(caplog):
    limit = np.full((3, 3), 2.0)
    dut = make_dut(WHEELS_AND_ARM, SIZES, -limit, limit)
    for wheel in (5.0, 6.0, 1.0, 7.0):
        evaluate(dut, wheels=[wheel, -3.0], arm=[0.0, 0.0, 0.0])
    told = [record.getMessage() for record in caplog.records]
    assert told == [
        "actuator 0: the velocity command -3 is beyond the limit -2: it is cut to the limit",
        "actuator 2: the velocity command 5 is beyond the limit 2: it is cut to the limit",
    ]


def test_a_joint_told_to_go_beyond_its_range_stops_at_its_end():
    limit = np.array([[9.0, 0.5, 9.0], [9.0] * 3, [9.0] * 3])
    desired, _ = evaluate(make_dut(WHEELS_AND_ARM, SIZES, -limit, limit), wheels=[0, 0], arm=[0.7, 0.1, 0])
    assert (desired[1], desired[4]) == (0.5, 0.0)


@pytest.mark.parametrize(
    ("position", "expected"),
    [(-0.3, [-0.2, 0.0]), (-0.2, [-0.2, 0.0]), (-0.19, [-0.19, 0.1]), (0.49, [0.49, 0.1]), (0.7, [0.5, 0.0])],
)
def test_a_joint_stops_at_both_ends_of_its_range_and_moves_between_them(position, expected):
    only = ServoAssignment(("position",), (0.0,), (0,), (1,), (-1,))
    dut = make_dut(only, {"arm": 2}, np.array([[-0.2], [-9.0], [-9.0]]), np.array([[0.5], [9.0], [9.0]]))
    assert evaluate(dut, arm=[position, 0.1])[0] == expected


def test_a_joint_that_is_held_at_an_end_of_its_range_moves_at_a_velocity():
    only = ServoAssignment(("velocity",), (0.5,), (-1,), (0,), (-1,))
    dut = make_dut(only, {"arm": 1}, np.array([[-0.2], [-9.0], [-9.0]]), np.array([[0.5], [9.0], [9.0]]))
    assert evaluate(dut, arm=[-0.3])[0] == [0.5, -0.3]


def test_a_command_at_a_limit_is_not_cut(caplog):
    limit = np.full((3, 3), 2.0)
    evaluate(make_dut(WHEELS_AND_ARM, SIZES, -limit, limit), wheels=[2.0, -2.0], arm=[2.0, -2.0, 2.0])
    assert not caplog.records


def test_for_a_continuous_plant_velocities_are_positions_ahead_by_the_seconds_of_their_mode():
    free = np.full((3, 3), np.inf)
    seconds = {"velocity": (0.5, 0.5, 0.25), "position": (0.1, 0.1, 0.1)}
    dut = JointServo(SIZES, WHEELS_AND_ARM, -free, free, as_position=seconds)
    desired, _ = evaluate(dut, wheels=[5.0, 6.0], arm=[0.7, 0.1, 9.0])
    assert desired == pytest.approx([6.0 * 0.5, 0.7 + 0.1 * 0.1, 5.0 * 0.25, 0.0, 0.0, 0.0])


def test_an_assignment_can_change_while_the_commands_stay():
    dut = make_dut(WHEELS_AND_ARM, SIZES)
    context = dut.CreateDefaultContext()
    dut.get_controller_input_port("wheels").FixValue(context, [5.0, 6.0])
    dut.get_controller_input_port("arm").FixValue(context, [0.7, 0.1, 9.0])
    dut.get_desired_state_output_port().Eval(context)
    held = ServoAssignment(("hold",) * 3, (1.0, 2.0, 3.0), (-1,) * 3, (-1,) * 3, (-1,) * 3)
    dut.assign(context, held)
    assert dut.assignment(context) == held
    assert dut.get_desired_state_output_port().Eval(context) == pytest.approx([1, 2, 3, 0, 0, 0])


@pytest.fixture
def motor():
    """A wheel of 2 kg·m² in a world without gravity, whose actuator is a servo of velocity."""
    plant = MultibodyPlant(time_step=0.001)
    body = plant.AddRigidBody("wheel", SpatialInertia(2.0, [0, 0, 0], UnitInertia(1, 1, 1)))
    joint = plant.AddJoint(RevoluteJoint("j", plant.world_frame(), body.body_frame(), [0, 0, 1]))
    actuator = plant.AddJointActuator("j", joint)
    plant.Finalize()
    return actuator


def test_an_effort_drives_its_joint_to_its_velocity_limit_with_that_effort_at_most(motor):
    modes = ServoAssignment(("limited", "position"), (0.0, 0.2), (-1, -1), (-1, -1), (0, -1))
    free = np.full((3, 2), np.inf)
    dut = JointServo({"force": 1}, modes, -free, free, limited={"limited": {0: (motor, 6.0), 1: (motor, 7.0)}})
    desired, efforts = evaluate(dut, force=[-3.0])
    assert (desired, efforts) == ([0.0, 0.2, -6.0, 0.0], [-3.0, 0.0])
    assert motor.effort_limit() == 3.0
    assert evaluate(dut, force=[0.5])[0] == [0.0, 0.2, 6.0, 0.0]
    assert motor.effort_limit() == 0.5
    desired, efforts = evaluate(dut, force=[0.0])
    assert (desired, efforts) == ([0.0, 0.2, 0.0, 0.0], [0.0, 0.0])
    assert 0 < motor.effort_limit() < 1e-9  # none to speak of; Drake's limits are above zero


@pytest.mark.parametrize(
    ("change", "fits"),
    [
        ({}, True),
        ({"holds": (0.0, 0.0)}, False),
        ({"efforts": (-1, 5, -1)}, False),  # there are the values 0 to 4
        ({"velocities": (-2, -1, -1)}, False),
    ],
)
def test_an_assignment_that_does_not_fit_is_refused(change, fits):
    dut = make_dut(WHEELS_AND_ARM, SIZES)
    with nullcontext() if fits else pytest.raises(ValueError, match="there are 3 actuators, and 5 values"):
        dut.check(replace(WHEELS_AND_ARM, **change))
