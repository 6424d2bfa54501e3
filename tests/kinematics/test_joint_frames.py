"""Frames of joints against Drake's own transforms, multiplied one after the other."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix

from drake_twin.description.robot_description import Joint, Pose
from drake_twin.kinematics.joint_frames import JointFrames

numbers = st.floats(-3, 3)
triples = st.tuples(numbers, numbers, numbers)
poses = st.builds(Pose, triples, triples)
axes = triples.filter(lambda axis: np.linalg.norm(axis) > 0.1).map(lambda axis: tuple(axis / np.linalg.norm(axis)))
joints = st.builds(
    Joint,
    st.just("j"),
    st.sampled_from(["revolute", "continuous", "prismatic", "fixed"]),
    st.just("a"),
    st.just("b"),
    poses,
    axes,
    child_origin=st.one_of(st.just(Pose()), poses),
)


def rigid(pose):
    return RigidTransform(RollPitchYaw(*pose.rpy), np.array(pose.xyz))


def check(pairs):
    """Compare the poses of joints' child links at positions with Drake's."""
    frames = JointFrames([joint for joint, _ in pairs])
    positions = np.array([0.0 if joint.type == "fixed" else position for joint, position in pairs])
    xyz, quaternions = frames.xyz(positions), frames.quaternions(positions)
    for index, (joint, _) in enumerate(pairs):
        if joint.type == "prismatic":
            moved = RigidTransform(positions[index] * np.array(joint.axis))
        else:
            moved = RigidTransform(RotationMatrix(AngleAxis(positions[index], joint.axis)), np.zeros(3))
        expected = rigid(joint.origin) @ moved @ rigid(joint.child_origin)
        assert xyz[index] == pytest.approx(expected.translation(), abs=1e-12)
        wxyz = expected.rotation().ToQuaternion().wxyz()
        assert abs(quaternions[index] @ wxyz) == pytest.approx(1.0, abs=1e-12)
        if not frames.moves_along[index]:
            assert xyz[index] == pytest.approx(frames.xyz(np.zeros(len(pairs)))[index], abs=1e-12)


@given(st.lists(st.tuples(joints, numbers), min_size=1, max_size=4))
def test_child_links_are_where_drake_puts_them(pairs):
    check(pairs)


def test_a_few_child_links_are_where_drake_puts_them():
    axis, origin, child = (0.6, 0.0, 0.8), Pose((1.0, -0.2, 0.3), (0.4, -0.5, 0.6)), Pose((0.1, 0.7, -0.4), (1, 2, 3))
    kinds = ["revolute", "prismatic", "continuous", "fixed"]
    check([(Joint("j", kind, "a", "b", origin, axis, child_origin=child), 0.7 + i) for i, kind in enumerate(kinds)])
    check([(Joint("j", kind, "a", "b", origin, axis), -1.3) for kind in kinds])


def test_no_joints_have_no_frames():
    frames = JointFrames([])
    assert (frames.xyz(np.zeros(0)).shape, frames.quaternions(np.zeros(0)).shape) == ((0, 3), (0, 4))


def test_a_joint_moves_its_child_along_where_it_slides_or_turns_beside_its_axis():
    """A child link on the axis of its joint only turns."""
    origin, beside, on_axis = Pose((1.0, 2.0, 3.0)), Pose((0.0, 0.5, 0.7)), Pose((0.0, 0.0, 0.7))
    kinds = [("revolute", on_axis), ("continuous", beside), ("prismatic", on_axis), ("prismatic", beside)]
    frames = JointFrames([Joint("j", kind, "a", "b", origin, (0.0, 0.0, 1.0), child_origin=at) for kind, at in kinds])
    assert frames.moves_along.tolist() == [False, True, True, True]
