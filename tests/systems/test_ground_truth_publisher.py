from types import SimpleNamespace

import numpy as np
import pytest

from drake_twin.description.robot_description import Pose
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.messages.interface_types import serialize
from drake_twin.systems.ground_truth_publisher import GroundTruthPublisher, RobotBase

FLOATING = StateLayout(size=13, positions={}, velocities={}, efforts={}, base_position=0, base_velocity=7)
FIXED = StateLayout(size=0, positions={}, velocities={}, efforts={})


def evaluate(base, state):
    dut = GroundTruthPublisher([base], len(state))
    context = dut.CreateDefaultContext()
    dut.get_state_input_port().FixValue(context, state)
    return dut.get_odom_output_port(base.robot).Eval(context)


def facing_y(x=1.0, angular=(0, 0, 0), linear=(0, 0, 0)):
    quaternion = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]
    return [*quaternion, x, 2.0, 3.0, *angular, *linear]


def test_the_pose_is_that_of_the_base_in_the_world():
    message = evaluate(RobotBase("robot_1", "robot_1/base_link", FLOATING), facing_y())
    position, orientation = message.pose.pose.position, message.pose.pose.orientation
    assert (message.header.frame_id, message.child_frame_id) == ("world", "robot_1/base_link")
    assert (position.x, position.y, position.z) == (1, 2, 3)
    assert (orientation.w, orientation.z) == pytest.approx((np.sqrt(0.5), np.sqrt(0.5)))


def test_the_twist_is_in_the_bases_own_frame():
    message = evaluate(RobotBase("r", "base", FLOATING), facing_y(angular=(0.5, 0, 1), linear=(0, 2, 0)))
    linear, angular = message.twist.twist.linear, message.twist.twist.angular
    assert (linear.x, linear.y, linear.z) == pytest.approx((2, 0, 0))
    assert (angular.x, angular.y, angular.z) == pytest.approx((0, -0.5, 1))


def test_a_draft_has_the_bytes_of_the_message_on_the_port():
    base, state = RobotBase("r", "base", FLOATING), np.array(facing_y(angular=(0.5, 0, 1), linear=(0, 2, 0)))
    draft = GroundTruthPublisher([base], 13).drafter(base)(SimpleNamespace(time=0.0, state=state))
    expected = evaluate(base, state)
    assert draft.serialized() == serialize(expected) == serialize(draft.message())


def test_the_covariances_are_matrices_of_six_by_six_zeros():
    message = evaluate(RobotBase("r", "base", FLOATING), facing_y())  # float64[36] in geometry_msgs
    assert message.pose.covariance.tolist() == message.twist.covariance.tolist() == [0.0] * 36
    with pytest.raises(ValueError, match="read-only"):  # all messages share them
        message.pose.covariance[0] = 1.0


def test_each_robot_has_a_port_with_its_own_place():
    layouts = {
        name: FLOATING.within([*range(7 * index, 7 * index + 7), *range(14 + 6 * index, 20 + 6 * index)])
        for index, name in enumerate("ab")
    }
    dut = GroundTruthPublisher([RobotBase(name, name, layout) for name, layout in layouts.items()], 26)
    context = dut.CreateDefaultContext()
    first, second = facing_y(5.0), facing_y(6.0, linear=(0, 3, 0))
    dut.get_state_input_port().FixValue(context, [*first[:7], *second[:7], *first[7:], *second[7:]])
    a, b = (dut.get_odom_output_port(name).Eval(context) for name in "ab")
    assert (a.child_frame_id, a.pose.pose.position.x, a.twist.twist.linear.x) == ("a", 5, 0)
    assert (b.child_frame_id, b.pose.pose.position.x) == ("b", 6)
    assert b.twist.twist.linear.x == pytest.approx(3)


def test_a_welded_base_has_its_fixed_pose_and_no_twist():
    message = evaluate(RobotBase("r", "base", FIXED, Pose((1, 0, 0), (0, 0, np.pi))), np.zeros(0))
    assert message.pose.pose.position.x == 1
    assert message.pose.pose.orientation.z == pytest.approx(1)
    assert message.twist.twist.linear.x == 0


def test_a_base_must_either_float_or_be_welded():
    with pytest.raises(ValueError, match="either moves or has a fixed pose"):
        RobotBase("r", "base", FLOATING, Pose())
