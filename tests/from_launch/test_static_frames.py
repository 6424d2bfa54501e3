from math import pi

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.from_launch.static_frames import static_frame
from drake_twin.ros2.launched import LaunchedProcess


def frame(*words):
    arguments = tuple(map(str, words))
    return static_frame(LaunchedProcess("node", "static_transform_publisher", Place("f", 3), arguments=arguments))


def rotation(transform):
    return Rotation.from_euler("xyz", transform.rpy)  # about fixed axes, as setRPY does


def test_the_old_form_is_yaw_pitch_roll():
    result = frame(1, -2, 3, 0.1, 0.2, 0.3, "/map", "odom")
    assert (result.parent, result.child, result.xyz, result.rpy) == ("map", "odom", (1, -2, 3), (0.3, 0.2, 0.1))


def test_the_new_form_in_any_order():
    words = ("--child-frame-id", "odom", "--yaw", -0.5, "--x", "-1e-1", "--frame-id=map", "--roll", 0.2)
    result = frame(*words)
    assert (result.parent, result.child, result.xyz, result.rpy) == ("map", "odom", (-0.1, 0, 0), (0.2, 0, -0.5))


UPRIGHT = [(roll, pitch, yaw) for pitch in (-pi / 2, pi / 2) for roll, yaw in ((0, 0), (0.4, 0), (0, -2.0), (1.0, 3.0))]
RANDOM = np.random.default_rng(3).uniform(-3, 3, size=(30, 3)).tolist()
NEAR = [(0.3, pi / 2 - 1e-5, 0.7), (-0.3, -pi / 2 + 1e-6, 0.7), (0.3, pi / 2 - 1e-9, 0.7), (0, pi, 0), (pi, 0, 0)]


@pytest.mark.parametrize("rpy", [*UPRIGHT, *RANDOM, *NEAR], ids=str)
def test_both_quaternion_forms_give_the_rotation_that_scipy_reads(rpy):
    expected = Rotation.from_euler("xyz", rpy)
    x, y, z, w = expected.as_quat() * 1.5  # not normalized
    old = frame(0, 0, 0, x, y, z, w, "a", "b")
    new = frame("--frame-id", "a", "--child-frame-id", "b", "--qx", x, "--qy", y, "--qz", z, "--qw", w)
    for result in (old, new):
        assert (rotation(result) * expected.inv()).magnitude() < 1e-6


def test_a_quaternions_missing_parts_are_those_of_no_rotation():
    result = frame("--frame-id", "a", "--child-frame-id", "b", "--qz", 1)
    assert rotation(result).as_rotvec() == pytest.approx([0, 0, pi / 2])  # (0, 0, 1, 1) normalized


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((0, 0, 0, 0, 0, 0, "a", "b", "--x", 1), "the old form of arguments"),
        ((0, 0, 0, 0, 0, 0, "a"), "it has 7 arguments; 8"),
        ((), "it has 0 arguments"),
        ((0, 0, 0, 0, 0, 0, "a", "b", 100), "must all be numbers"),  # ROS 1's period
        ((0, 0, 0, 0, 0, 0, 0, "a", "b"), "the quaternion is zero"),
        ((0, 0, "nan", 0, 0, 0, "a", "b"), "a number is not finite"),
        (("--x", 1, "--child-frame-id", "b"), "--frame-id is missing"),
        (("--frame-id", "a"), "--child-frame-id is missing"),
        (
            ("--frame-id", "a", "--child-frame-id", "b", "--yaw", 1, "--qw", 1),
            "roll, pitch, yaw and a quaternion exclude",
        ),
        (("--frame-id", "a", "--child-frame-id", "b", "--height", 1), "unknown option --height"),
        (("--frame-id", "a", "--child-frame-id", "b", "--x", "far"), "-x is 'far', which is not a number"),
    ],
)
def test_what_ros_refuses_is_refused(words, message):
    with pytest.raises(InputError, match=f"f:3: .*{message}"):
        frame(*words)
