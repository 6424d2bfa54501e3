"""Clocks that nodes make themselves, of each kind."""

import pytest

from drake_twin.nodes.rclpy.clock import Clock, ClockType, ROSClock


def test_a_clock_of_ros_time_is_a_ros_clock_and_others_are_not():
    kinds = {kind: type(Clock(clock_type=kind)) for kind in ClockType}
    assert kinds[ClockType.ROS_TIME] is ROSClock
    assert {kind for kind, made in kinds.items() if made is Clock} == {*ClockType} - {ClockType.ROS_TIME}
    assert Clock().clock_type is ClockType.SYSTEM_TIME
    assert ROSClock().clock_type is ClockType.ROS_TIME
    with pytest.raises(TypeError, match="Clock type must be a ClockType enum"):
        Clock(clock_type=1)
