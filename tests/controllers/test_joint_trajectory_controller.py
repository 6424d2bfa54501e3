import copy
import math
from types import SimpleNamespace

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import PdControllerGains
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder, LeafSystem
from scipy.interpolate import BPoly, CubicHermiteSpline

from drake_twin import messages
from drake_twin.control.tolerances import StateTolerance, Tolerances
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.joint_trajectory_controller import ACTION, TOPIC, JointTrajectoryController
from drake_twin.controllers.joint_trajectory_parameters import (
    JointConstraints,
    JointTrajectoryGains,
    JointTrajectoryParameters,
    SpeedScaling,
    TrajectoryConstraints,
)
from drake_twin.controllers.registry import controller_class
from drake_twin.description.controllers_yaml import ControllerParameters, read_controllers
from drake_twin.description.parameters import parameter_names, read_parameters
from drake_twin.description.robot_description import Joint, RobotDescription
from drake_twin.errors import CommandError, InputError
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.systems.no_message import empty_value, make_value, or_none

PERIOD = 0.01
JOINTS = ("a", "b")


def description(kind="revolute"):
    joints = tuple(Joint(name, kind, "base", f"{name}_link") for name in JOINTS)
    return RobotDescription("arm", ("base", "a_link", "b_link"), joints)


def make_dut(commands=("position",), states=("position", "velocity"), kind="revolute", step=0.0, **parameters):
    parameters = JointTrajectoryParameters(JOINTS, tuple(commands), tuple(states), **parameters)
    robot = description(kind)
    claims = JointTrajectoryController.claimed_interfaces(parameters, robot)
    layout = StateLayout(4, {"a": 0, "b": 1}, {"a": 2, "b": 3}, {"a": 0, "b": 1}, 2)
    setup = ControllerSetup("arm_controller", parameters, claims, robot, layout, PERIOD, physics_step=step)
    return JointTrajectoryController(setup)


class Rig:
    """A controller by itself; its joints stand where the test puts them, or go where they are commanded."""

    def __init__(self, *arguments, state=(0.0, 0.0, 0.0, 0.0), active=True, **more):
        self.dut = make_dut(*arguments, **more)
        self.simulator = Simulator(self.dut)
        self.context = self.simulator.get_mutable_context()
        self.put(state)
        if active:
            self.dut.activate(self.context)

    def fix(self, topic, value):
        self.dut.GetInputPort(topic).FixValue(self.context, make_value(value))

    def put(self, state):
        self.dut.get_state_input_port().FixValue(self.context, np.array(state, dtype=float))

    def send(self, message, topic=TOPIC):
        value = self.dut.read(topic, message, self.context)
        self.fix(topic, value)
        return getattr(value, "id", None)

    def send_goal(self, trajectory, path=(), goal=(), time=0.0):
        return self.send(goal_message(trajectory, path, goal, time), ACTION)

    @property
    def time(self):
        return self.context.get_time()

    @property
    def commands(self):
        return self.dut.get_command_interfaces_output_port().Eval(self.context)

    @property
    def state(self):
        return or_none(self.dut.GetOutputPort("controller_state").Eval(self.context))

    @property
    def goal(self):
        return self.dut.goal_state(self.context)

    def update(self, perfect=False):
        """The update that is due now; joints that are perfect stand where the trajectory has them."""
        if perfect:
            self.put([*self.reference(self.time), 0.0, 0.0])
        return self.simulator.AdvancePendingEvents()

    def advance(self, time, perfect=False):
        """All updates up to a time and the one at it; returns their times and commands."""
        times, commands = [], []
        for k in range(round(self.time / PERIOD) + 1, round(time / PERIOD) + 1):
            self.simulator.AdvanceTo(k * PERIOD)
            self.status = self.update(perfect)
            times.append(self.time)
            commands.append(self.commands)
        return np.array(times), np.array(commands)

    def reference(self, time):
        running = self.dut.sample(self.context).memory.running
        return np.array(running.sample(time).point.positions)


def message(points, times, joints=JOINTS, stamp=0.0):
    """A JointTrajectory; a point is a tuple of positions, or a dict."""
    fields = ("positions", "velocities", "accelerations", "effort")
    points = [point if isinstance(point, dict) else {"positions": point} for point in points]
    return messages.JointTrajectory(
        header=messages.header(stamp),
        joint_names=list(joints),
        points=[
            messages.JointTrajectoryPoint(
                **{field: np.array(point.get(field, ()), dtype=float) for field in fields},
                time_from_start=messages.duration_message(time),
            )
            for point, time in zip(points, times, strict=True)
        ],
    )


def goal_message(trajectory, path=(), goal=(), time=0.0):
    def tolerances(given):
        return [
            messages.JointTolerance(name=name, position=position, velocity=0.0, acceleration=0.0)
            for name, position in given
        ]

    return messages.FollowJointTrajectory_Goal(
        trajectory=trajectory,
        multi_dof_trajectory=messages.MultiDOFJointTrajectory(header=messages.header(0.0), joint_names=[], points=[]),
        path_tolerance=tolerances(path),
        component_path_tolerance=[],
        goal_tolerance=tolerances(goal),
        component_goal_tolerance=[],
        goal_time_tolerance=messages.duration_message(time),
    )


GOAL = message([(1.0, -2.0)], [1.0])
MIDDLE = PERIOD / 2  # a set-point is that of the middle of the time for which it stands


def started(trajectory=GOAL, topic=TOPIC, state=(0.0, 0.0, 0.0, 0.0), tolerances=None, **parameters):
    """A rig that has just taken up a trajectory."""
    rig = Rig(state=state, **parameters)
    rig.update()
    rig.id = rig.send(trajectory) if topic == TOPIC else rig.send_goal(trajectory, **(tolerances or {}))
    rig.advance(PERIOD)
    rig.start = rig.time
    return rig


def mean_velocity(spline, times):
    return np.array([(spline(t + PERIOD) - spline(t)) / PERIOD for t in times])


# --- what stands in the behaviour table -------------------------------------------------------------------------------


def test_the_topic_and_the_action_are_where_ros2_has_them():
    dut = make_dut()
    assert dut.subscribed["joint_trajectory"] == "trajectory_msgs/msg/JointTrajectory"
    assert dut.actions == {"follow_joint_trajectory": "control_msgs/action/FollowJointTrajectory"}
    assert dut.published == {"controller_state": "control_msgs/msg/JointTrajectoryControllerState"}
    assert controller_class("joint_trajectory_controller/JointTrajectoryController") is JointTrajectoryController


def test_before_the_first_message_the_joints_are_held_where_they_are():
    rig = Rig(state=(0.3, -0.4, 0.0, 0.0))
    assert np.isnan(rig.commands).all()
    rig.update()
    assert rig.commands.tolist() == [0.3, -0.4, 0.0, 0.0]
    rig.put((0.5, 0.5, 0.0, 0.0))
    assert rig.advance(1.0)[1][-1].tolist() == [0.3, -0.4, 0.0, 0.0]


def test_position_is_linear():
    rig = started(message([(1.0, -2.0), (0.0, -2.0)], [0.5, 1.5]))
    times, commands = rig.advance(1.4)
    knots = rig.start + np.array([0.0, 0.5, 1.5])
    for i, values in enumerate(([0.0, 1.0, 0.0], [0.0, -2.0, -2.0])):
        assert commands[:, i] == pytest.approx(np.interp(times + MIDDLE, knots, values), abs=1e-12)
        later, now = np.interp(times + PERIOD, knots, values), np.interp(times, knots, values)
        assert commands[:, 2 + i] == pytest.approx((later - now) / PERIOD, abs=1e-11)


def test_position_and_velocity_are_cubic():
    point = [{"positions": (1.0, -2.0), "velocities": (0.5, 0.0)}, {"positions": (0.0, 1.0), "velocities": (0.0, 0.0)}]
    rig = started(message(point, [0.5, 1.5]), state=(0.1, 0.2, -0.3, 0.4))
    spline = CubicHermiteSpline(
        rig.time + np.array([0.0, 0.5, 1.5]),
        [(0.1, 0.2), (1.0, -2.0), (0.0, 1.0)],
        [(-0.3, 0.4), (0.5, 0.0), (0.0, 0.0)],
    )
    times, commands = rig.advance(1.4)
    assert commands[:, :2] == pytest.approx(spline(times + MIDDLE), abs=1e-12)
    assert commands[:, 2:] == pytest.approx(mean_velocity(spline, times), abs=1e-11)


def test_position_velocity_and_acceleration_are_quintic():
    point = [
        {"positions": (1.0, -2.0), "velocities": (0.5, 0.0), "accelerations": (1.0, -1.0)},
        {"positions": (0.0, 1.0), "velocities": (0.0, 0.0), "accelerations": (0.0, 0.0)},
    ]
    rig = started(message(point, [0.5, 1.5]), commands=("position", "velocity"), state=(0.1, 0.2, -0.3, 0.4))
    derivatives = [
        [(0.1, 0.2), (-0.3, 0.4), (0.0, 0.0)],
        [(1.0, -2.0), (0.5, 0.0), (1.0, -1.0)],
        [(0.0, 1.0), (0.0, 0.0), (0.0, 0.0)],
    ]
    spline = BPoly.from_derivatives(rig.time + np.array([0.0, 0.5, 1.5]), derivatives)
    times, commands = rig.advance(1.4)
    assert commands[:, [0, 2]] == pytest.approx(spline(times + MIDDLE), abs=1e-12)
    assert commands[:, [1, 3]] == pytest.approx(spline(times + MIDDLE, 1), abs=1e-11)


def test_the_set_point_is_that_of_the_time_at_which_it_acts():
    # Written at t, it acts in the steps that end from t + h to t + P: their mean is t + (P + h) / 2.
    point = [{"positions": (1.0, -2.0), "velocities": (0.0, 0.0)}]
    step = 0.002
    rig = started(message(point, [1.0]), step=step)
    spline = CubicHermiteSpline(rig.start + np.array([0.0, 1.0]), [(0.0, 0.0), (1.0, -2.0)], np.zeros((2, 2)))
    times, commands = rig.advance(0.9)
    assert commands[:, :2] == pytest.approx(spline(times + (PERIOD + step) / 2), abs=1e-12)
    assert commands[:, 2:] == pytest.approx(mean_velocity(spline, times), abs=1e-11)


@pytest.mark.parametrize(
    ("trajectory", "text"),
    [
        (message([], []), "has no points"),
        (message([(0.0, 0.0)], [1.0], joints=("a", "c")), "the trajectory names an unknown joint 'c'"),
        (message([(0.0,)], [1.0]), "point 0 of the trajectory has 1 positions for 2 joints: a, b"),
        (message([(0.0,)], [1.0], joints=("a",)), "leaves out b"),
        (message([(0.0, 0.0)] * 2, [1.0, 1.0]), "the times of the trajectory do not increase"),
        (message([(0.0, 0.0)], [1.0], stamp=0.5), "ends in the past: it starts at 0.5 s and ends at 1.5 s"),
        (message([{"positions": (0, 0), "velocities": (0, 0.1)}], [1.0]), "ends with a velocity of 0.1 at joint b"),
        (message([(0.0, math.inf)], [1.0]), "has inf among its positions, for joint b"),
    ],
    ids=["empty", "unknown joint", "size", "partial", "time not increasing", "past", "moving at the end", "infinite"],
)
@pytest.mark.parametrize("topic", [TOPIC, ACTION])
def test_a_bad_trajectory_is_rejected_and_the_present_one_goes_on(trajectory, text, topic):
    rig = started(state=(0.0, 0.0, 0.0, 0.0))
    rig.advance(2.0)
    with pytest.raises(CommandError, match=text):
        rig.send(trajectory) if topic == TOPIC else rig.send_goal(trajectory)
    rig.advance(2.5)
    assert rig.commands.tolist() == [1.0, -2.0, 0.0, 0.0]


def test_a_goal_succeeds_at_its_end_and_stops_the_run_there():
    rig = started(topic=ACTION)
    assert (rig.goal.status, rig.goal.is_done) == ("executing", False)
    rig.advance(rig.start + 1.0 - PERIOD, perfect=True)
    assert rig.goal.status == "executing"
    rig.advance(rig.start + 1.0, perfect=True)
    assert (rig.goal.id, rig.goal.status, rig.goal.error_code) == (rig.id, "succeeded", 0)
    assert rig.goal.error_string == "Goal successfully reached!"
    assert "kReachedTermination" in str(rig.status.reason())
    rig.advance(rig.time + 10 * PERIOD)
    assert "Termination" not in str(rig.status.reason())
    assert rig.commands.tolist() == [1.0, -2.0, 0.0, 0.0]


def test_a_violated_path_tolerance_aborts_and_holds():
    constraints = TrajectoryConstraints(joints={"b": JointConstraints(trajectory=0.1)})
    rig = started(topic=ACTION, constraints=constraints)
    rig.advance(PERIOD * 5)  # the joints do not move: b, at 2 m/s, is 0.08 behind
    assert rig.goal.status == "executing"
    rig.put((0.02, -0.01, 0.0, 0.0))
    rig.advance(PERIOD * 7)
    assert (rig.goal.status, rig.goal.error_code) == ("aborted", -4)
    assert rig.goal.error_string.startswith(
        "Aborted due to path tolerance violation: the position error of joint b is -0.11, its tolerance 0.1"
    )
    assert rig.commands.tolist() == [0.02, -0.01, 0.0, 0.0]
    rig.put((0.5, 0.5, 0.0, 0.0))
    rig.advance(1.0)
    assert rig.commands.tolist() == [0.02, -0.01, 0.0, 0.0]


def test_a_violated_path_tolerance_holds_without_a_goal_too():
    rig = started(constraints=TrajectoryConstraints(joints={"b": JointConstraints(trajectory=0.1)}))
    rig.advance(0.5)
    assert rig.goal is None
    assert rig.commands.tolist() == [0.0, 0.0, 0.0, 0.0]


def test_goal_time_zero_waits_for_the_goal_tolerance_for_ever():
    rig = started(topic=ACTION, constraints=TrajectoryConstraints(joints={"a": JointConstraints(goal=0.05)}))
    rig.advance(30.0)
    assert rig.goal.status == "executing"
    rig.put((0.96, -2.0, 0.0, 0.0))
    rig.advance(30.0 + PERIOD)
    assert rig.goal.status == "succeeded"


def test_goal_time_aborts_when_it_has_passed_and_holds():
    constraints = TrajectoryConstraints(goal_time=0.3, joints={"a": JointConstraints(goal=0.05)})
    rig = started(topic=ACTION, constraints=constraints, state=(0.5, 0.0, 0.0, 0.0))
    rig.advance(rig.start + 1.3)
    assert rig.goal.status == "executing"
    rig.advance(rig.start + 1.3 + PERIOD)
    assert (rig.goal.status, rig.goal.error_code) == ("aborted", -5)
    assert "exceeding by 0.310000 seconds: the position error of joint a is 0.5" in rig.goal.error_string
    assert rig.commands.tolist() == [0.5, 0.0, 0.0, 0.0]


def test_stopped_velocity_tolerance_keeps_a_goal_waiting_while_the_joints_still_move():
    gains = dict.fromkeys(JOINTS, JointTrajectoryGains(p=1.0))
    rig = started(topic=ACTION, commands=("velocity",), gains=gains)
    rig.put((1.0, -2.0, 0.0, 0.011))
    rig.advance(2.0)
    assert rig.goal.status == "executing"
    rig.put((1.0, -2.0, 0.0, 0.009))
    rig.advance(2.0 + PERIOD)
    assert rig.goal.status == "succeeded"


def test_a_trajectory_that_is_over_at_its_first_update_is_judged_by_the_path_tolerance_too():
    constraints = TrajectoryConstraints(joints={"a": JointConstraints(trajectory=0.1)})
    rig = started(message([(1.0, 0.0)], [0.0]), topic=ACTION, constraints=constraints)
    assert (rig.goal.status, rig.goal.error_code) == ("aborted", -4)


@pytest.mark.parametrize("pushed", [False, True])
def test_nothing_is_judged_while_the_joints_are_held(pushed):
    # Neither after a success nor after an abort does a push make the controller hold the joints elsewhere.
    constraints = TrajectoryConstraints(goal_time=0.1, joints={"a": JointConstraints(0.2, 0.05)})
    rig = started(topic=ACTION, constraints=constraints)
    rig.advance(2.0, perfect=not pushed)
    assert rig.goal.status == ("aborted" if pushed else "succeeded")
    before = rig.commands.tolist()
    rig.put((9.0, 9.0, 0.0, 0.0))
    rig.advance(4.0)
    assert rig.commands.tolist() == before


# --- goals ------------------------------------------------------------------------------------------------------------


def test_tolerances_sent_with_a_goal_come_before_the_parameters():
    constraints = TrajectoryConstraints(joints={"b": JointConstraints(trajectory=0.1)})
    rig = started(topic=ACTION, constraints=constraints, tolerances={"path": [("b", -1.0), ("a", 0.3)]})
    rig.advance(0.3)
    assert rig.goal.status == "executing"
    rig.advance(0.4)
    assert "the position error of joint a" in rig.goal.error_string


def test_goal_tolerances_sent_with_a_goal_hold_for_that_goal_only():
    rig = started(topic=ACTION, tolerances={"goal": [("a", 0.01)], "time": 0.1})
    rig.advance(1.3)
    assert rig.goal.error_code == -5
    rig.send_goal(message([(1.0, 0.0)], [0.1]))
    rig.advance(1.6)
    assert rig.goal.status == "succeeded"


def test_a_goal_with_invalid_tolerances_runs_with_the_default_ones_and_the_error_is_logged(caplog):
    constraints = TrajectoryConstraints(joints={"b": JointConstraints(trajectory=0.1)})
    given = {"path": [("b", 9.0), ("c", 0.1)]}  # test_tolerances.cpp:446: those of b are not used either
    rig = started(topic=ACTION, constraints=constraints, tolerances=given)
    assert "path_tolerance names an unknown joint 'c'" in caplog.text
    assert "the default tolerances are used" in caplog.text
    rig.advance(0.3)
    assert "the position error of joint b" in rig.goal.error_string


TRIPLE = ("position", "velocity", "acceleration")


@pytest.mark.parametrize("joint", ["", "c"])
@pytest.mark.parametrize("where", ["path", "goal"])
@pytest.mark.parametrize("field", TRIPLE)
def test_every_invalid_tolerance_means_the_default_ones(where, field, joint, caplog):
    """test_tolerances.cpp:222-478; without a joint's name the tolerance of joint a is -123."""
    rig = Rig(constraints=TrajectoryConstraints(goal_time=0.25))
    goal = goal_message(GOAL, **{where: [("a", 0.0)]}, time=3.0)
    (tolerance,) = goal.path_tolerance or goal.goal_tolerance
    setattr(tolerance, "name" if joint else field, joint or -123.0)
    command = rig.dut.read(ACTION, goal, rig.context)
    defaults = Tolerances((StateTolerance(),) * 2, (StateTolerance(0.0, 0.01),) * 2, 0.25)
    assert command.tolerances == defaults
    assert "the default tolerances are used" in caplog.text


def test_a_negative_goal_time_means_the_default_tolerances():
    rig = Rig(constraints=TrajectoryConstraints(goal_time=0.25))  # test_tolerances.cpp:222
    assert rig.dut.read(ACTION, goal_message(GOAL, time=-123.0), rig.context).tolerances.goal_time == 0.25


def test_a_newer_goal_preempts():
    rig = started(topic=ACTION)
    rig.advance(0.5, perfect=True)
    second = rig.send_goal(message([(5.0, 5.0)], [1.0]))
    assert second > rig.id
    assert (rig.goal.id, rig.goal.status) == (second, "accepted")
    rig.advance(0.51, perfect=True)
    assert (rig.goal.id, rig.goal.status) == (second, "executing")


def test_a_goal_that_is_replaced_before_it_was_taken_up_is_preempted_too():
    rig = Rig()
    first, second = rig.send_goal(GOAL), rig.send_goal(GOAL)
    rig.update()
    assert first < rig.goal.id == second


@pytest.mark.parametrize("is_waiting", [False, True])
def test_a_trajectory_on_the_topic_preempts_a_goal(is_waiting):
    rig = Rig()
    goal = rig.send_goal(GOAL)
    if not is_waiting:
        rig.update()
        rig.advance(0.1, perfect=True)
    rig.send(message([(3.0, 3.0)], [0.2]))
    rig.update() if is_waiting else rig.advance(0.11, perfect=True)
    assert (rig.goal.id, rig.goal.status, rig.goal.error_code) == (goal, "aborted", -1)
    rig.advance(0.5, perfect=True)
    assert rig.commands[:2].tolist() == [3.0, 3.0]
    assert rig.goal.status == "aborted"


def test_the_newer_of_topic_and_goal_is_followed_whichever_port_it_is_on():
    rig = Rig()
    rig.send(message([(3.0, 3.0)], [0.2]))
    rig.send_goal(GOAL)
    rig.update()
    rig.advance(2.0, perfect=True)
    assert rig.goal.status == "succeeded"
    assert rig.commands[:2].tolist() == [1.0, -2.0]


def test_cancel_holds_the_joints_where_they_are():
    rig = started(topic=ACTION)
    rig.advance(0.5, perfect=True)
    rig.put((0.4, -0.9, 1.0, -2.0))
    rig.dut.cancel(rig.context)
    assert rig.goal.status == "canceled"
    rig.advance(1.0)
    assert rig.commands.tolist() == [0.4, -0.9, 0.0, 0.0]
    assert rig.goal.status == "canceled"


def test_cancel_of_a_goal_that_waits_keeps_it_from_being_taken_up():
    rig = Rig(state=(0.2, 0.2, 0.0, 0.0))
    rig.send_goal(GOAL)
    rig.dut.cancel(rig.context)
    rig.update()
    rig.advance(1.0)
    assert rig.goal.status == "canceled"
    assert rig.commands.tolist() == [0.2, 0.2, 0.0, 0.0]


def test_cancel_brakes_where_decelerations_are_given():
    limits = {name: JointConstraints(max_deceleration_on_cancel=2.0) for name in JOINTS}
    rig = started(topic=ACTION, constraints=TrajectoryConstraints(decelerate_on_cancel=True, joints=limits))
    rig.put((0.0, 0.0, 1.0, 0.0))
    rig.dut.cancel(rig.context)
    start = rig.time
    rig.advance(start + 0.2)
    assert rig.commands[0] == pytest.approx(0.2 + MIDDLE - (0.2 + MIDDLE) ** 2)
    rig.advance(start + 1.0)
    assert rig.commands.tolist() == pytest.approx([0.25, 0.0, 0.0, 0.0])


def test_a_goal_is_refused_by_a_controller_that_is_not_active():
    with pytest.raises(CommandError, match="not active"):
        Rig(active=False).send_goal(GOAL)


def test_deactivation_aborts_the_goal_and_writes_nothing():
    rig = started(topic=ACTION)
    rig.dut.deactivate(rig.context)
    assert (rig.goal.status, rig.goal.error_code) == ("aborted", -1)
    assert rig.goal.error_string == "Current goal cancelled during deactivate transition."
    assert np.isnan(rig.commands).all()
    assert rig.state is None


def test_feedback_tells_desired_actual_and_error():
    rig = started(topic=ACTION)
    rig.put((0.2, 0.0, 0.0, 0.0))
    rig.advance(rig.start + 0.5)
    feedback = rig.dut.feedback(rig.context)
    assert feedback.joint_names == ["a", "b"]
    assert feedback.header.stamp == messages.time_message(rig.time)
    assert feedback.desired.positions == pytest.approx([0.5, -1.0])
    assert feedback.actual.positions.tolist() == [0.2, 0.0]
    assert feedback.error.positions == pytest.approx([0.3, -1.0])
    assert feedback.desired.time_from_start == messages.duration_message(0.5)
    assert feedback.actual.time_from_start == messages.duration_message(0.5)


# --- parameters -------------------------------------------------------------------------------------------------------


def test_controller_state_tells_reference_feedback_error_and_output():
    rig = started()
    rig.put((0.2, 0.0, 0.1, 0.0))
    rig.advance(rig.start + 0.5)
    state = rig.state
    assert state.header.stamp == messages.time_message(rig.time)
    assert state.joint_names == ["a", "b"]
    assert state.reference.time_from_start == state.feedback.time_from_start == messages.duration_message(0.5)
    assert state.reference.positions == pytest.approx([0.5, -1.0])
    assert state.reference.velocities == pytest.approx([1.0, -2.0])
    assert state.feedback.velocities.tolist() == [0.1, 0.0]
    assert state.error.positions == pytest.approx([0.3, -1.0])
    assert state.output.positions == pytest.approx([0.505, -1.01])
    assert state.output.velocities.tolist() == []
    assert state.speed_scaling_factor == 1.0
    store = messages.type_store()
    assert store.serialize_cdr(state, "control_msgs/msg/JointTrajectoryControllerState")


def test_joints_are_matched_by_name_and_not_by_order():
    rig = started(message([(7.0, 8.0)], [0.1], joints=("b", "a")))
    rig.advance(0.5)
    assert rig.commands[:2].tolist() == [8.0, 7.0]


def test_a_partial_goal_leaves_the_other_joints_where_they_are_commanded():
    rig = started(message([(1.0,)], [0.1], joints=("b",)), allow_partial_joints_goal=True, state=(0.3, 0.0, 0, 0))
    rig.put((0.25, 0.0, 0.0, 0.0))
    rig.send(message([(2.0,)], [0.1], joints=("b",)))
    rig.advance(0.5)
    assert rig.commands[:2].tolist() == [0.3, 2.0]


def test_velocities_alone_are_integrated_where_that_is_allowed():
    points = [{"velocities": (1.0, 0.0)}, {"velocities": (0.0, 0.0)}]
    rig = started(message(points, [1.0, 2.0]), allow_integration_in_goal_trajectories=True)
    rig.advance(2.5)
    assert rig.commands[:2].tolist() == [1.0, 0.0]


def test_a_trajectory_of_the_future_ends_at_its_stamp():
    rig = Rig()
    rig.update()
    rig.send(message([(1.0, 0.0)], [1.0], stamp=2.0))
    rig.advance(0.01)
    rig.advance(1.5)
    assert rig.commands[0] == pytest.approx((1.5 + MIDDLE - 0.01) / 2.99)
    rig.advance(3.0)
    assert rig.commands[0] == 1.0


def test_a_new_trajectory_begins_at_the_measured_state():
    rig = started()
    rig.advance(0.5)
    rig.send(message([(1.0, 1.0)], [1.0]))
    rig.put((0.2, 0.3, 0.0, 0.0))
    rig.advance(0.51)
    assert rig.commands[:2] == pytest.approx([0.2 + 0.8 * MIDDLE, 0.3 + 0.7 * MIDDLE])


@pytest.mark.parametrize("name", ["open_loop_control", "interpolate_from_desired_state"])
def test_a_new_trajectory_begins_at_the_set_point_in_open_loop(name):
    rig = started(**{name: True})
    rig.advance(0.5)
    rig.send(message([(1.0, 1.0)], [1.0]))
    rig.put((0.2, 0.3, 0.0, 0.0))
    rig.advance(0.51)
    assert rig.commands[:2] == pytest.approx([0.5 + 0.5 * MIDDLE, -1.0 + 2.0 * MIDDLE])


def test_a_continuous_joint_goes_on_from_its_own_turns_in_open_loop():
    rig = started(
        message([(0.5, 0.0)], [0.1]), kind="continuous", state=(20 * math.pi, 0.0, 0, 0), open_loop_control=True
    )
    rig.advance(0.5)
    rig.send(message([(0.7, 0.0)], [0.1]))
    rig.advance(1.0)
    assert rig.commands[0] == pytest.approx(20 * math.pi + 0.7)


def test_cmd_timeout_gives_a_trajectory_up():
    rig = started(topic=ACTION, cmd_timeout=0.5, tolerances={"goal": [("a", 0.1)]})
    rig.advance(rig.start + 1.5)
    assert rig.commands[0] == 1.0
    rig.advance(rig.start + 1.51)
    assert rig.commands.tolist() == [0.0, 0.0, 0.0, 0.0]
    assert rig.goal.error_string.startswith("Aborted due to command timeout")


def test_without_interpolation_the_points_are_commanded_as_they_are():
    rig = started(message([(1.0, 1.0), (2.0, 2.0)], [0.5, 1.0]), interpolation_method="none")
    _, commands = rig.advance(1.5)
    assert sorted(set(commands[:, 0])) == [0.0, 2.0]
    assert not commands[:, 2:].any()


def test_a_continuous_joint_goes_the_short_way_whatever_turns_it_has_made():
    rig = started(message([(0.5, 3.0)], [1.0]), kind="continuous", state=(20 * math.pi, -3.0, 0.0, 0.0))
    rig.advance(2.0)
    assert rig.commands[:2] == pytest.approx([20 * math.pi + 0.5, 3.0 - 2 * math.pi], abs=1e-9)
    assert rig.state.reference.positions == pytest.approx([0.5, 3.0])
    rig.put((*rig.commands[:2], 0.0, 0.0))
    rig.advance(2.0 + PERIOD)
    assert rig.state.error.positions == pytest.approx([0.0, 0.0], abs=1e-9)


def test_speed_scaling_slows_a_trajectory_down():
    rig = started(speed_scaling=SpeedScaling(initial_scaling_factor=0.5))
    begin = rig.start
    rig.advance(begin + 1.0)
    assert rig.commands == pytest.approx([0.5 + 0.5 * MIDDLE, -1.0 - MIDDLE, 0.5, -1.0])
    rig.send(SimpleNamespace(factor=0.0), "speed_scaling_input")
    rig.advance(begin + 1.0 + 0.5)
    assert rig.commands == pytest.approx([0.5, -1.0, 0.0, 0.0])
    assert rig.state.speed_scaling_factor == 0.0
    with pytest.raises(CommandError, match="factor -1 is not"):
        rig.send(SimpleNamespace(factor=-1.0), "speed_scaling_input")


@pytest.mark.parametrize("factor", [0.0, 0.5, 0.9])
def test_a_slowed_down_trajectory_can_be_cancelled_between_two_updates(factor):
    rig = started(topic=ACTION, speed_scaling=SpeedScaling(initial_scaling_factor=factor))
    rig.advance(rig.start + 0.5)
    rig.simulator.AdvanceTo(rig.time + 1e-4)
    rig.dut.cancel(rig.context)
    held = None
    for k in range(1, 5):
        rig.advance(rig.start + 0.5 + k * PERIOD)
        held = rig.commands if held is None else held
        assert rig.commands == pytest.approx(held)
    assert np.isfinite(rig.commands).all()


def test_a_controller_that_is_activated_again_holds_what_it_commanded_last():
    rig = started()
    rig.advance(2.0)
    rig.put((0.99, -1.99, 0.0, 0.0))
    rig.advance(2.01)
    rig.dut.deactivate(rig.context)
    rig.fix(TOPIC, None)
    rig.dut.activate(rig.context)
    rig.advance(2.02)
    assert rig.commands[:2].tolist() == [1.0, -2.0]


@pytest.mark.parametrize(("parameter", "moved"), [(True, True), (False, False)])
def test_a_controller_that_is_activated_again_holds_joints_that_were_moved_where_they_are(parameter, moved):
    rig = started(set_last_command_interface_value_as_state_on_activation=parameter)
    rig.put((0.99, -1.99, 0.0, 0.0))
    rig.advance(2.01)
    rig.dut.deactivate(rig.context)
    rig.put((0.5 if moved else 0.99, -1.99, 0.0, 0.0))
    rig.dut.activate(rig.context)
    rig.advance(2.02)
    assert rig.commands[:2].tolist() == [0.5 if moved else 0.99, -1.99]


def test_a_message_from_before_the_activation_is_not_taken_up():
    rig = started()
    rig.dut.deactivate(rig.context)
    rig.dut.activate(rig.context)
    rig.advance(2.0)
    assert rig.commands[:2].tolist() != [1.0, -2.0]


def test_a_copied_context_goes_on_as_the_original_does():
    rig = started(topic=ACTION)
    rig.advance(0.3)
    other = Rig()
    other.context.SetTimeStateAndParametersFrom(rig.context)
    for topic in (TOPIC, ACTION):
        other.fix(topic, copy.deepcopy(rig.dut.received(rig.dut.GetInputPort(topic), rig.context)))
    other.simulator.Initialize()
    for each in (rig, other):
        each.advance(0.6)
    assert other.commands.tolist() == rig.commands.tolist()
    assert other.goal == rig.goal


# --- other interfaces -------------------------------------------------------------------------------------------------


def test_claims_are_those_of_each_joint_in_the_order_of_the_parameters():
    dut = make_dut(commands=("position", "velocity"))
    assert list(map(str, dut.claims)) == ["a/position", "a/velocity", "b/position", "b/velocity"]
    assert dut.feedforward == ()
    assert make_dut().feedforward == (Interface("a", "velocity"), Interface("b", "velocity"))


def test_accelerations_are_left_out_with_a_warning():
    dut = make_dut(commands=("position", "velocity", "acceleration"))
    assert [claim.name for claim in dut.claims] == ["position", "velocity"] * 2
    assert dut.warnings == ("the twin neither measures nor commands accelerations: these interfaces are left out",)


def test_the_velocity_interface_gets_feed_forward_and_pid():
    gains = {"a": JointTrajectoryGains(p=3.0, ff_velocity_scale=1.0), "b": JointTrajectoryGains(d=0.5)}
    rig = started(commands=("velocity",), gains=gains)
    rig.put((0.1, 0.0, 0.0, 0.4))
    rig.advance(rig.start + 0.5)
    assert rig.commands == pytest.approx([1.0 + 3.0 * (0.5 - 0.1), 0.5 * (-2.0 - 0.4)])


def test_the_velocity_interface_in_open_loop_gets_the_velocity():
    rig = started(commands=("velocity",), open_loop_control=True)
    rig.advance(0.5)
    assert rig.commands == pytest.approx([1.0, -2.0])


def test_the_effort_interface_gets_the_points_efforts_and_pid():
    points = [{"positions": (1.0, 1.0), "effort": (2.0, 4.0)}]
    gains = {name: JointTrajectoryGains(p=10.0, i=2.0) for name in JOINTS}
    rig = started(message(points, [1.0]), commands=("effort",), gains=gains, state=(0.0, 1.0, 0.0, 0.0))
    begin = rig.start
    rig.advance(begin + 0.5)
    integral = 2.0 * sum(0.01 * PERIOD * k for k in range(51))
    assert rig.commands == pytest.approx([10.0 * 0.5 + integral + 2.0 * (0.5 + MIDDLE), 4.0 * (0.5 + MIDDLE)])


def test_a_pid_acts_at_the_very_first_update():
    rig = Rig(commands=("effort",), gains={"a": JointTrajectoryGains(d=3.0)}, state=(0.0, 0.0, 0.5, 0.0))
    rig.update()
    assert rig.commands.tolist() == [-1.5, 0.0]


def test_a_reference_of_another_controller_gets_no_feedforward():
    dut = make_dut(command_joints=("pid/a", "pid/b"))
    assert list(map(str, dut.claims)) == ["pid/a/position", "pid/b/position"]
    assert dut.feedforward == ()


def test_a_pid_without_gains_commands_nothing_but_zero():
    rig = started(commands=("effort",))
    rig.advance(0.5)
    assert rig.commands.tolist() == [0.0, 0.0]


def test_fewer_joints_may_be_commanded_than_are_watched():
    rig = started(command_joints=("b",))
    rig.advance(2.0)
    assert rig.dut.claims == (Interface("b", "position"),)
    assert rig.commands.tolist() == [-2.0, 0.0]


@pytest.mark.parametrize(
    ("commands", "states", "more", "text"),
    [
        ((), ("position",), {}, "'command_interfaces' is empty"),
        (("velocity", "effort"), ("position", "velocity"), {}, "'velocity' must be alone or with 'position'"),
        (("effort", "acceleration"), ("position", "velocity"), {}, "'acceleration' needs 'position' and 'velocity'"),
        (("position", "velocity", "effort"), ("position", "velocity"), {}, "'effort' must be alone or with 'position'"),
        (("position",), ("velocity",), {}, "state interface 'position' is missing"),
        (("velocity",), ("position",), {}, "velocity need the state interface 'velocity'"),
        (("position", "position"), ("position",), {}, "'command_interfaces' has a duplicate name"),
        (("position",), ("position",), {"command_joints": ("c",)}, "the command joint 'c' is not in 'joints'"),
    ],
)
def test_interfaces_that_do_not_go_together_are_refused(commands, states, more, text):
    with pytest.raises(InputError, match=text):
        make_dut(commands, states, **more)


def test_parameters_are_read_as_upstreams_yaml_has_them():
    yaml = {
        "joints": ["a", "b"],
        "command_interfaces": ["position"],
        "state_interfaces": ["position", "velocity"],
        "constraints": {"goal_time": 0.6, "a": {"trajectory": 0.2, "goal": 0.1}},
        "constraints.b.goal": 0.3,
        "gains": {"a": {"p": 100, "i_clamp": 1.0}},
        "action_monitor_rate": 10.0,
    }
    parameters, warnings = read_parameters(
        JointTrajectoryParameters, ControllerParameters("arm_controller", "joint_trajectory_controller/x", yaml)
    )
    assert parameters.constraints.goal_time == 0.6
    assert parameters.constraints.joints == {
        "a": JointConstraints(trajectory=0.2, goal=0.1),
        "b": JointConstraints(goal=0.3),
    }
    assert parameters.gains["a"].pid_gains.i_clamp_min == -1.0
    assert tuple(map(str, warnings)) == (
        "controller arm_controller: action_monitor_rate is ignored: the end of a goal is reported at once",
    )
    names = {name for name, _, _ in parameter_names(JointTrajectoryParameters)}
    assert {"constraints.<joint>.goal", "constraints.goal_time", "gains.<joint>.p"} <= names


def test_a_wrong_value_below_a_joint_is_told_with_its_line(tmp_path):
    file = tmp_path / "controllers.yaml"
    file.write_text(
        "controller_manager:\n  ros__parameters:\n    arm:\n      type: joint_trajectory_controller/x\n"
        "arm:\n  ros__parameters:\n    joints: [a]\n    command_interfaces: [position]\n"
        "    state_interfaces: [position]\n    constraints:\n      a:\n        goal: far\n"
    )
    (controller,) = read_controllers(file, "", {}).controllers
    with pytest.raises(InputError, match=r"controllers.yaml:12: .*'far' is not a number"):
        read_parameters(JointTrajectoryParameters, controller)


def test_the_trajectory_controllers_of_other_peoples_robots_are_built_from_their_own_yaml(corpus):
    kind = "joint_trajectory_controller/JointTrajectoryController"
    built = {}
    for file in sorted(corpus.glob("**/*.yaml")):
        if kind not in file.read_text():
            continue
        for namespace in ("", "/rrbot", "/rrbot_1"):
            for controller in read_controllers(file, namespace, {}).controllers:
                if controller.type == kind and controller.parameters.get("joints"):
                    built[file.name, controller.name] = build(controller)
    assert len(built) >= 7
    unsaid = [text for warnings in built.values() for text in warnings if "state_publish_rate" not in text]
    assert not unsaid


def build(controller):
    """The warnings with which a controller is built and steps."""
    parameters, warnings = read_parameters(JointTrajectoryParameters, controller)
    joints, n = parameters.joints, len(parameters.joints)
    robot = RobotDescription("robot", ("base",), tuple(Joint(name, "revolute", "base", name) for name in joints))
    layout = StateLayout(
        2 * n, {name: i for i, name in enumerate(joints)}, {name: n + i for i, name in enumerate(joints)}, {}
    )
    claims = JointTrajectoryController.claimed_interfaces(parameters, robot)
    dut = JointTrajectoryController(ControllerSetup(controller.name, parameters, claims, robot, layout, PERIOD))
    simulator = Simulator(dut)
    context = simulator.get_mutable_context()
    dut.get_state_input_port().FixValue(context, np.full(2 * n, 0.25))
    dut.activate(context)
    simulator.AdvanceTo(0.1)
    assert dut.fault(context) is None
    assert np.isfinite(dut.get_command_interfaces_output_port().Eval(context)).all()
    return (*map(str, warnings), *dut.warnings)


def test_parameters_without_effect_are_told():
    dut = make_dut(
        cmd_timeout=1.0,
        gains={"c": JointTrajectoryGains()},
        constraints=TrajectoryConstraints(goal_time=2.0, decelerate_on_cancel=True),
    )
    assert [text.split(" ")[0] for text in dut.warnings] == [
        "gains",
        "cmd_timeout",
        "decelerate_on_cancel",
    ]


# --- a plant ----------------------------------------------------------------------------------------------------------

ARM = """
<robot name="arm">
  <link name="base"/>
  <link name="a_link"><inertial><origin xyz="0.2 0 0"/><mass value="3"/>
    <inertia ixx="0.01" iyy="0.04" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="b_link"><inertial><origin xyz="0.2 0 0"/><mass value="2"/>
    <inertia ixx="0.01" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="a" type="continuous"><parent link="base"/><child link="a_link"/><axis xyz="0 1 0"/></joint>
  <joint name="b" type="continuous"><parent link="a_link"/><child link="b_link"/><origin xyz="0.4 0 0"/>
    <axis xyz="0 1 0"/></joint>
</robot>
"""


class Servo(LeafSystem):
    """The commands as a desired state [q_d; v_d], which the claims and the feedforward make; at first zero."""

    def __init__(self):
        super().__init__()
        self.DeclareVectorInputPort("commands", 4)
        self.DeclareVectorOutputPort("desired_state", 4, self._calc)

    def _calc(self, context, output):
        output.SetFromVector(np.nan_to_num(self.get_input_port().Eval(context)))


def tracking_error(step, duration=2.0):
    """The largest error of two joints under gravity that follow a cubic with implicit PD servos (rad)."""
    builder = DiagramBuilder()
    plant = builder.AddSystem(MultibodyPlant(step))
    plant.SetUseSampledOutputPorts(False)
    (instance,) = Parser(plant).AddModelsFromString(ARM, "urdf")
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    for name, inertia, load in (("a", 1.2, 18.0), ("b", 0.12, 4.0)):
        actuator = plant.AddJointActuator(name, plant.GetJointByName(name))
        stiffness = max(16.0 * inertia / 0.2**2, load / 5e-4)  # those of diagram/servo_gains.py
        actuator.set_controller_gains(PdControllerGains(p=stiffness, d=0.2 * stiffness))
    plant.Finalize()
    dut = builder.AddSystem(make_dut(step=step))
    builder.Connect(plant.get_state_output_port(instance), dut.get_state_input_port())
    servo = builder.AddSystem(Servo())
    builder.Connect(dut.get_command_interfaces_output_port(), servo.get_input_port())
    builder.Connect(servo.get_output_port(), plant.get_desired_state_input_port(instance))
    simulator = Simulator(builder.Build())
    context = dut.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    point = {"positions": (1.5, -1.0), "velocities": (0.0, 0.0)}
    dut.GetInputPort(ACTION).FixValue(context, empty_value())
    dut.activate(context)
    value = dut.read(TOPIC, message([point], [duration]), context)
    dut.get_joint_trajectory_input_port().FixValue(context, make_value(value))
    spline = CubicHermiteSpline([0.0, duration], [(0.0, 0.0), (1.5, -1.0)], np.zeros((2, 2)))
    worst = 0.0
    for k in range(1, round((duration + 0.5) / PERIOD)):
        simulator.AdvanceTo(k * PERIOD)
        actual = plant.GetPositions(plant.GetMyContextFromRoot(simulator.get_context()))
        worst = max(worst, np.max(np.abs(actual - spline(min(k * PERIOD, duration)))))
    return worst


@pytest.mark.parametrize("step", [0.001, 0.01])
def test_joints_of_a_plant_follow_a_cubic_of_two_seconds(step):
    # Measured: 5e-4 rad at both, which is how much these servos sag under gravity.
    assert tracking_error(step) < 1e-3
