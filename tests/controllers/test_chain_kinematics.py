"""The chain's poses against trigonometry, its Jacobian against differences of poses."""

from math import cos, sin

import numpy as np
import pytest
from six_axis_arm import ARM, JOINTS

from drake_twin.controllers.chain_kinematics import ChainKinematics, joints_between
from drake_twin.description.robot_description import Joint, Pose, RobotDescription

POSITIONS = np.array([0.3, -0.5, 0.9, 1.1, -0.7, 0.4])
PLANAR = RobotDescription(
    name="planar",
    links=("base", "upper", "lower", "tip", "lid"),
    joints=(
        Joint("shoulder", "revolute", "base", "upper", axis=(0.0, 0.0, 1.0)),
        Joint("elbow", "revolute", "upper", "lower", Pose((2.0, 0.0, 0.0)), axis=(0.0, 0.0, 1.0)),
        Joint("reach", "prismatic", "lower", "tip", Pose((1.0, 0.0, 0.0)), axis=(1.0, 0.0, 0.0)),
        Joint("hinge", "revolute", "base", "lid"),
    ),
)


def test_a_pose_is_that_of_trigonometry():
    # joints in another order than the file's
    chain = ChainKinematics(PLANAR, "base", ("reach", "shoulder", "elbow"), 0.0)
    pose = chain.pose(np.array([0.5, 0.4, 0.3]), "tip")
    expected = [2 * cos(0.4) + 1.5 * cos(0.7), 2 * sin(0.4) + 1.5 * sin(0.7), 0.0]
    np.testing.assert_allclose(pose.translation(), expected, atol=1e-15)
    np.testing.assert_allclose(pose.rotation().matrix()[:2, 0], [cos(0.7), sin(0.7)], atol=1e-15)


def test_a_pose_is_relative_to_the_base():
    chain = ChainKinematics(PLANAR, "upper", ("elbow", "reach"), 0.0)
    np.testing.assert_allclose(
        chain.pose(np.array([0.3, 0.5]), "tip").translation(), [2 + 1.5 * cos(0.3), 1.5 * sin(0.3), 0.0]
    )


def test_the_jacobian_is_the_derivative_of_the_pose():
    chain = ChainKinematics(ARM, "base_link", JOINTS, 0.0)
    jacobian = chain.jacobian(POSITIONS, "tool0")
    step = 1e-6
    for index in range(6):
        ahead, behind = (chain.pose(POSITIONS + sign * step * np.eye(6)[index], "tool0") for sign in (1, -1))
        linear = (ahead.translation() - behind.translation()) / (2 * step)
        turn = (ahead.rotation() @ behind.rotation().inverse()).ToAngleAxis()
        np.testing.assert_allclose(jacobian[:3, index], linear, atol=1e-9)
        np.testing.assert_allclose(jacobian[3:, index], turn.angle() * turn.axis() / (2 * step), atol=1e-9)


def test_deltas_are_converted_both_ways():
    chain = ChainKinematics(ARM, "base_link", JOINTS, 1e-12)
    deltas = np.array([0.1, -0.2, 0.3, 0.05, -0.06, 0.07])
    joints = chain.joint_deltas(POSITIONS, deltas, "tool0")
    np.testing.assert_allclose(chain.cartesian_deltas(POSITIONS, joints, "tool0"), deltas, atol=1e-8)


def test_the_inverse_is_damped():
    chain = ChainKinematics(PLANAR, "base", ("reach",), 0.25)
    joints = chain.joint_deltas(np.zeros(1), np.array([1.0, 7.0, 8.0, 9.0, 10.0, 11.0]), "tip")
    np.testing.assert_allclose(joints, [1.0 / (1.0 + 0.25)])


@pytest.mark.parametrize(
    ("base", "link", "joints"),
    [
        ("base", "tip", {"shoulder", "elbow", "reach"}),
        ("upper", "tip", {"elbow", "reach"}),
        ("base", "base", set()),
        ("lid", "lower", {"hinge", "shoulder", "elbow"}),
    ],
)
def test_joints_between_two_links(base, link, joints):
    assert joints_between(PLANAR, base, link) == joints


def test_fixed_joints_move_nothing():
    assert joints_between(ARM, "link_6", "tool0") == frozenset()
