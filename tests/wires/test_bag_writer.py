"""The quality of service that a bag keeps of each topic, which ``ros2 bag play`` offers again."""

import pytest

from drake_twin.wires.bag_writer import _quality


@pytest.mark.parametrize(("latched", "depth", "durability"), [(False, 10, "VOLATILE"), (True, 1, "TRANSIENT_LOCAL")])
def test_a_latched_topic_keeps_its_last_message_and_others_ten_for_who_listens(latched, depth, durability):
    """As a publisher of rclpy with the profile of this depth, and of ``robot_description``; times without an end."""
    quality = _quality(latched)
    assert (quality.history.name, quality.depth, quality.durability.name) == ("KEEP_LAST", depth, durability)
    assert (quality.reliability.name, quality.liveliness.name) == ("RELIABLE", "AUTOMATIC")
    forever = {
        (time.sec, time.nsec) for time in (quality.deadline, quality.lifespan, quality.liveliness_lease_duration)
    }
    assert forever == {(2**31 - 1, 2**32 - 1)}  # DDS's Duration_t of infinity
    assert not quality.avoid_ros_namespace_conventions
