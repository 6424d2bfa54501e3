"""The times of transforms that are put together of others."""

import pytest

from drake_twin import messages
from drake_twin.messages.transform_tree import TransformTree


def stamped(parent, child, seconds):
    place = messages.Transform(messages.Vector3(1.0, 0.0, 0.0), messages.Quaternion(0.0, 0.0, 0.0, 1.0))
    return messages.TransformStamped(messages.header(seconds, parent), child, place)


@pytest.mark.parametrize(
    ("outer", "inner", "nanoseconds"),
    [
        ("map", "base", 2_000_000_000),
        ("base", "map", 2_000_000_000),
        ("odom", "camera", 3_500_000_000),
        ("left", "right", 1_000_000_000),
        ("base", "camera", None),
        ("base", "base", None),
    ],
)
def test_a_transform_is_as_old_as_the_oldest_in_it_but_for_static_ones(outer, inner, nanoseconds):
    tree = TransformTree()
    moving = [("map", "odom", 2.0), ("odom", "base", 3.0), ("odom", "base", 3.5), ("camera", "right", 4.0)]
    moving += [("base", "left", 1.0)]
    tree.add(messages.TFMessage([stamped(*item) for item in moving]), is_static=False)
    tree.add(messages.TFMessage([stamped("base", "camera", 0.0)]), is_static=True)
    assert tree.look_up(outer, inner).time == nanoseconds
