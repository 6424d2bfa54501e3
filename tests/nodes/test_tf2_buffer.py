"""Transforms in a buffer: chains and interpolation against SciPy, behaviour as upstream's tests assert it.

Lines cited are those of geometry2 (branch jazzy): tf2_py/test/test_buffer_core.py where no file is named.
"""

import math

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation, Slerp

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.duration import Duration
from drake_twin.nodes.rclpy.time import Time
from drake_twin.nodes.tf2_py import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TransformException,
)

Stamped = message_class("geometry_msgs/msg/TransformStamped")
Stamp = message_class("builtin_interfaces/msg/Time")


def stamped(parent, child, seconds=0.0, translation=(2.0, 0.0, 0.0), rotation=None):
    """A transform; ``rotation`` is SciPy's."""
    made = Stamped(child_frame_id=child)
    made.header.frame_id = parent
    nanoseconds = round(seconds * 1e9)
    made.header.stamp = Stamp(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
    moved, turned = made.transform.translation, made.transform.rotation
    moved.x, moved.y, moved.z = map(float, translation)
    if rotation is not None:
        turned.x, turned.y, turned.z, turned.w = map(float, rotation.as_quat())
    return made


def filled(*transforms, static=()):
    buffer = BufferCore()
    for each in transforms:
        buffer.set_transform(each, "test")
    for each in static:
        buffer.set_transform_static(each, "test")
    return buffer


def at(seconds):
    return Time(seconds=seconds)


def matrix(found):
    """The 4×4 matrix of a transform."""
    made = np.eye(4)
    turned, moved = found.transform.rotation, found.transform.translation
    made[:3, :3] = Rotation.from_quat([turned.x, turned.y, turned.z, turned.w]).as_matrix()
    made[:3, 3] = moved.x, moved.y, moved.z
    return made


def random_transforms(count, seed):
    generator = np.random.default_rng(seed)
    rotations = Rotation.random(count, rng=generator)
    return [(generator.normal(size=3), rotations[index]) for index in range(count)]


def test_chains_are_products_of_matrices():
    """w ← a ← b ← c and w ← d ← e: each pair of frames, against products of 4×4 matrices."""
    edges = [("w", "a"), ("a", "b"), ("b", "c"), ("w", "d"), ("d", "e")]
    values = random_transforms(len(edges), seed=3)
    made = [stamped(*edge, 1.0, *value) for edge, value in zip(edges, values, strict=True)]
    buffer = filled(*made[:3], static=made[3:])
    in_world = {"w": np.eye(4)}
    for (parent, child), each in zip(edges, made, strict=True):
        in_world[child] = in_world[parent] @ matrix(each)
    for target in in_world:
        for source in in_world:
            found = buffer.lookup_transform_core(target, source, at(1.0))
            expected = np.linalg.inv(in_world[target]) @ in_world[source]
            np.testing.assert_allclose(matrix(found), expected, atol=1e-14)
            assert (found.header.frame_id, found.child_frame_id) == (target, source)
            assert buffer.can_transform_core(target, source, at(1.0)) == (True, "")


@pytest.mark.parametrize("ratio", [0.0, 0.1, 0.5, 0.77, 1.0])
@pytest.mark.parametrize("seed", range(6))
def test_interpolation_is_scipys_slerp(seed, ratio):
    (first, one), (second, other) = random_transforms(2, seed)
    buffer = filled(stamped("w", "a", 1.0, first, one), stamped("w", "a", 3.0, second, other))
    found = buffer.lookup_transform_core("w", "a", at(1.0 + 2 * ratio))
    expected = np.eye(4)
    expected[:3, :3] = Slerp([0, 1], Rotation.concatenate([one, other]))(ratio).as_matrix()
    expected[:3, 3] = (1 - ratio) * first + ratio * second
    np.testing.assert_allclose(matrix(found), expected, atol=1e-12)
    assert found.header.stamp.sec + 1e-9 * found.header.stamp.nanosec == pytest.approx(1.0 + 2 * ratio, abs=1e-9)


def test_a_quaternion_and_its_negative_are_one_rotation():
    """Interpolation takes the shortest path (tf2/LinearMath/Quaternion.h:318-342)."""
    one, other = Rotation.from_euler("z", 0.2), Rotation.from_euler("z", 0.4)
    reversed_sign = stamped("w", "a", 2.0, rotation=other)
    turned = reversed_sign.transform.rotation
    turned.x, turned.y, turned.z, turned.w = -turned.x, -turned.y, -turned.z, -turned.w
    found = filled(stamped("w", "a", 1.0, rotation=one), reversed_sign).lookup_transform_core("w", "a", at(1.5))
    assert 2 * math.atan2(found.transform.rotation.z, found.transform.rotation.w) == pytest.approx(0.3)


def test_signs_of_quaternions_are_those_of_matrices():
    """tf2 makes them from a matrix (LinearMath/Matrix3x3.h, getRotation), as SciPy's Rotation.from_matrix does."""
    for seed in range(20):
        ((_, rotation),) = random_transforms(1, seed)
        for sign in (1, -1):
            made = stamped("w", "a", 1.0, rotation=rotation)
            turned = made.transform.rotation
            turned.x, turned.y, turned.z, turned.w = (sign * float(part) for part in rotation.as_quat())
            found = filled(made).lookup_transform_core("w", "a", at(1.0)).transform.rotation
            leading = max((found.x, found.y, found.z), key=abs) if abs(found.w) <= 0.5 else found.w
            assert leading > 0


def test_full_lookup_goes_by_a_fixed_frame():
    """target ← fixed at one time, fixed ← source at another (tf2/src/buffer_core.cpp, second lookupTransformImpl)."""
    values = random_transforms(4, seed=8)
    made = [stamped("w", "a", time, *value) for time, value in zip((1.0, 2.0), values[:2], strict=True)]
    more = [stamped("w", "b", time, *value) for time, value in zip((1.0, 2.0), values[2:], strict=True)]
    buffer = filled(*made, *more)
    found = buffer.lookup_transform_full_core("a", at(2.0), "b", at(1.0), "w")
    np.testing.assert_allclose(matrix(found), np.linalg.inv(matrix(made[1])) @ matrix(more[0]), atol=1e-14)
    assert found.header.stamp.sec == 2
    assert buffer.can_transform_full_core("a", at(2.0), "b", at(1.0), "w") == (True, "")
    assert not buffer.can_transform_full_core("a", at(2.5), "b", at(1.0), "w")[0]


def test_frames_as_text():  # :74-92
    buffer = filled(stamped("bar", "foo"))
    assert yaml.safe_load(buffer.all_frames_as_yaml())["foo"]["parent"] == "bar"
    assert yaml.safe_load(buffer.all_frames_as_yaml())["foo"]["broadcaster"] == "test"
    assert buffer.all_frames_as_string() == "Frame foo exists with parent bar.\n"
    assert BufferCore().all_frames_as_yaml() == "[]"


def test_static_transforms_hold_at_all_times():  # :94-121
    assert filled(stamped("bar", "foo")).can_transform_core("bar", "foo", at(0.5))[0] == 0
    assert filled(static=[stamped("bar", "foo")]).can_transform_core("bar", "foo", at(0.5))[0] == 1


def test_can_transform():  # :123-168
    buffer = filled(stamped("bar", "foo", 1.0), stamped("bar", "foo", 2.0))
    assert buffer.can_transform_core(target_frame="foo", source_frame="bar", time=at(1.5)) == (True, "")
    can, why = buffer.can_transform_core(target_frame="foo", source_frame="bar", time=at(2.5))
    assert not can
    assert "extrapolation into the future" in why
    can, why = buffer.can_transform_core(target_frame="foo", source_frame="bar", time=at(0.5))
    assert not can
    assert "extrapolation into the past" in why


def test_latest_common_time():  # :190-207
    buffer = filled(*(stamped("bar", "foo", seconds) for seconds in (0.0, 1.0, 0.5)))
    assert buffer.get_latest_common_time("bar", "foo") == at(1.0)


def test_clear():  # :209-230
    buffer = filled(stamped("bar", "foo"))
    assert buffer.can_transform_core("foo", "bar", Time())[0]
    buffer.clear()
    assert not buffer.can_transform_core("foo", "bar", Time())[0]


def test_lookup():  # :232-261
    made = stamped("bar", "foo")
    assert filled(made).lookup_transform_core(target_frame="bar", source_frame="foo", time=Time()) == made
    with pytest.raises(LookupException):
        filled(made).lookup_transform_core(target_frame="bar", source_frame="baz", time=Time())


def test_the_latest_time_is_that_which_all_have():
    """It is the least of the newest times on the path without static ones (buffer_core.cpp, getLatestCommonTime)."""
    moving = [stamped("w", "a", seconds, (seconds, 0, 0)) for seconds in (1.0, 2.0, 3.0)]
    other = [stamped("w", "b", seconds, (0, seconds, 0)) for seconds in (1.0, 2.5)]
    buffer = filled(*moving, *other, static=[stamped("a", "tip", 0.0, (0, 0, 1))])
    found = buffer.lookup_transform_core("b", "tip", Time())
    assert (found.header.stamp.sec, found.header.stamp.nanosec) == (2, 500_000_000)
    assert (found.transform.translation.x, found.transform.translation.y) == pytest.approx((2.5, -2.5))
    back = buffer.lookup_transform_core("tip", "b", Time())
    assert back.header.stamp == found.header.stamp
    assert buffer.lookup_transform_core("a", "tip", Time()).header.stamp.sec == 0
    assert buffer.lookup_transform_core("w", "a", Time()).header.stamp.sec == 3


WORDS = [  # tf2/src/cache.cpp:67-103, tf2/src/buffer_core.cpp (validateFrameId, createConnectivityErrorString)
    ("foo", "bar", 2.5, ExtrapolationException, ("Lookup would require extrapolation into the future.  Requested time "
     "2.500000 but the latest data is at time 2.000000, when looking up transform from frame [bar] to frame [foo]")),
    ("bar", "foo", 0.5, ExtrapolationException, ("Lookup would require extrapolation into the past.  Requested time "
     "0.500000 but the earliest data is at time 1.000000, when looking up transform from frame [foo] to frame [bar]")),
    ("bar", "one", 0.5, ExtrapolationException, ("Lookup would require extrapolation at time 0.500000, but only time "
     "1.000000 is in the buffer, when looking up transform from frame [one] to frame [bar]")),
    ("bar", "island", 1.0, ConnectivityException, ("Could not find a connection between 'bar' and 'island' because "
     "they are not part of the same tree.Tf has two or more unconnected trees.")),
    ("baz", "foo", 1.0, LookupException, '"baz" passed to lookupTransform argument target_frame does not exist. '),
    ("bar", "baz", 1.0, LookupException, '"baz" passed to lookupTransform argument source_frame does not exist. '),
    ("", "foo", 1.0, InvalidArgumentException, ('Invalid argument "" passed to lookupTransform argument target_frame - '
     "in tf2 frame_ids cannot be empty")),
    ("/bar", "foo", 1.0, InvalidArgumentException, ('Invalid argument "/bar" passed to lookupTransform argument '
     "target_frame - in tf2 frame_ids cannot start with a '/'")),
]  # fmt: skip


@pytest.mark.parametrize(("target", "source", "seconds", "kind", "words"), WORDS)
def test_words_of_exceptions(target, source, seconds, kind, words):
    buffer = filled(
        stamped("bar", "foo", 1.0),
        stamped("bar", "foo", 2.0),
        stamped("bar", "one", 1.0),
        static=[stamped("sea", "island")],
    )
    with pytest.raises(kind) as refusal:
        buffer.lookup_transform_core(target, source, at(seconds))
    assert str(refusal.value) == words
    assert issubclass(kind, TransformException)
    can, why = buffer.can_transform_core(target, source, at(seconds))
    assert not can
    assert why == words or why.startswith(f'Invalid frame ID "{target if target != "bar" else source}" passed to can')


def test_the_identity_needs_no_frame():
    """buffer_core.cpp, lookupTransformImpl: the same frame twice is not validated."""
    found = BufferCore().lookup_transform_core("nowhere", "nowhere", at(3.0))
    assert found.transform.rotation.w == 1.0
    assert found.header.stamp.sec == 3
    assert BufferCore().can_transform_core("nowhere", "nowhere", at(3.0)) == (True, "")


def test_old_transforms_are_forgotten(capsys):
    """cache.cpp, pruneList and insertData: kept for ten seconds before the newest, or for the time given."""
    buffer = BufferCore(Duration(seconds=2))
    for seconds in (1.0, 2.0, 3.0, 4.0, 5.0):
        buffer.set_transform(stamped("w", "a", seconds), "test")
    assert buffer.can_transform_core("w", "a", at(2.0))[0]  # it goes when the next one comes
    buffer.set_transform(stamped("w", "a", 5.5), "test")
    assert not buffer.can_transform_core("w", "a", at(2.5))[0]
    assert buffer.can_transform_core("w", "a", at(3.0))[0]
    buffer.set_transform(stamped("w", "a", 3.4), "test")
    assert "TF_OLD_DATA ignoring data from the past for frame a at time 3.400000" in "".join(capsys.readouterr())
    with pytest.raises(TypeError, match=r"duration must have sec and nanosec, or nanoseconds\."):
        BufferCore(2)


def test_a_frame_that_gets_another_parent():
    """cache.cpp, getData: between two parents, the older transform counts."""
    buffer = filled(stamped("w", "a", 1.0, (1, 0, 0)), stamped("v", "a", 2.0, (5, 0, 0)), static=[stamped("w", "v")])
    assert buffer.lookup_transform_core("w", "a", at(1.5)).transform.translation.x == 1.0
    assert buffer.lookup_transform_core("v", "a", at(2.0)).transform.translation.x == 5.0


def test_a_loop_is_told():
    buffer = filled(static=[stamped("a", "b"), stamped("b", "a"), stamped("w", "x")])
    with pytest.raises(LookupException, match="The tf tree is invalid because it contains a loop"):
        buffer.lookup_transform_core("w", "a", at(1.0))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda made: setattr(made, "child_frame_id", "w"), "TF_SELF_TRANSFORM"),
        (lambda made: setattr(made, "child_frame_id", ""), "TF_NO_CHILD_FRAME_ID"),
        (lambda made: setattr(made.header, "frame_id", ""), "TF_NO_FRAME_ID"),
        (lambda made: setattr(made.transform.translation, "x", math.nan), "TF_NAN_INPUT"),
        (lambda made: setattr(made.transform.rotation, "w", 0.0), "TF_DENORMALIZED_QUATERNION"),
    ],
)
def test_transforms_that_cannot_be_are_told_and_left_out(change, words, capsys):  # buffer_core.cpp, setTransformImpl
    made = stamped("w", "a", 1.0)
    change(made)
    buffer = filled(made)
    assert words in "".join(capsys.readouterr())
    assert buffer._getFrameStrings() == []


def test_a_leading_slash_is_taken_off():
    assert filled(stamped("/w", "/a", 1.0)).can_transform_core("w", "a", at(1.0))[0]


def test_times_are_of_rclpy_or_of_messages():
    buffer = filled(stamped("w", "a", 1.0))
    assert buffer.can_transform_core("w", "a", Stamp(sec=1))[0]
    with pytest.raises(TypeError, match=r"time must have sec and nanosec, or nanoseconds\."):
        buffer.lookup_transform_core("w", "a", 1.0)
