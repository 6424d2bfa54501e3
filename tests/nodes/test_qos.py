"""Qualities of service: what publishers and subscriptions accept, as rclpy does."""

import pytest

from drake_twin.nodes.rclpy.qos_profiles import (
    HistoryPolicy,
    InvalidQoSProfileException,
    QoSPresetProfiles,
    QoSProfile,
    profile_of,
)


def test_a_profile_and_a_depth_are_profiles():
    own = QoSProfile(depth=3)
    assert profile_of(own) is own
    assert profile_of(True).depth == 1  # a whole number, as rclpy/node.py of 7.1.3 takes it
    for depth in (0, 1, 7):
        found = profile_of(depth)
        assert (found.history, found.depth) == (HistoryPolicy.KEEP_LAST, depth)


@pytest.mark.parametrize("other", [QoSPresetProfiles.SENSOR_DATA, None, 1.0, "1"])
def test_anything_else_is_refused(other):
    with pytest.raises(TypeError, match="Expected QoSProfile or int"):
        profile_of(other)


@pytest.mark.parametrize("depth", [1.0, "1"])
def test_a_depth_is_a_whole_number_from_zero(depth):
    with pytest.raises(AssertionError):
        QoSProfile(depth=depth)
    with pytest.raises(ValueError, match="history depth must be greater than or equal to zero"):
        profile_of(-1)


def test_only_what_keeps_all_needs_no_depth():
    assert QoSProfile(history=HistoryPolicy.KEEP_ALL).depth == 10
    with pytest.raises(InvalidQoSProfileException, match="without a depth setting"):
        QoSProfile(history=HistoryPolicy.KEEP_LAST)
    with pytest.raises(InvalidQoSProfileException, match="are required"):
        QoSProfile()
