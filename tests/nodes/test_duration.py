"""Spans of time as ``rclpy.duration`` has them."""

import pytest

from drake_twin.nodes.rclpy.duration import Duration


def test_spans_are_compared():
    one, two = Duration(seconds=1), Duration(nanoseconds=2_000_000_000)
    assert one == Duration(nanoseconds=10**9)
    assert one != two
    assert one != 10**9
    assert (one < two, two < one, one < Duration(seconds=1)) == (True, False, False)
    assert (one <= two, two <= one, one <= Duration(seconds=1)) == (True, False, True)
    assert (two > one, one > two, one > Duration(seconds=1)) == (True, False, False)
    assert (two >= one, one >= two, one >= Duration(seconds=1)) == (True, False, True)
    with pytest.raises(TypeError):
        assert one < 3


@pytest.mark.parametrize("act", [lambda one: one + one, lambda one: one - one, lambda one: one * 2, hash])
def test_jazzy_does_not_compute_with_spans(act):
    with pytest.raises(TypeError):
        act(Duration(seconds=1))


def test_a_span_is_whole_nanoseconds_of_64_bits():
    assert Duration(seconds=0.5, nanoseconds=7.9).nanoseconds == 500_000_007
    assert repr(Duration(seconds=1)) == "Duration(nanoseconds=1000000000)"
    assert str(Duration(seconds=1)) == "1000000000 nanoseconds"
    assert Duration(nanoseconds=-(2**63)).nanoseconds == -(2**63)
    for nanoseconds in (2**63, -(2**63) - 1):
        with pytest.raises(OverflowError, match="too large to store in C duration"):
            Duration(nanoseconds=nanoseconds)


def test_a_span_is_a_message_and_back():
    message = Duration(seconds=-1.5).to_msg()
    assert (message.sec, message.nanosec) == (-2, 500_000_000)
    assert Duration.from_msg(message) == Duration(seconds=-1.5)
