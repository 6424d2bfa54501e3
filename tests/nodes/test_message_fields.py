"""Fields of numbers in messages of Python, as rosidl_generator_py makes them, and in those of the twin."""

import array

import numpy as np
import pytest

from drake_twin.nodes.message_classes import from_wire, message_class, to_wire

Imu, Numbers, Bytes = map(
    message_class, ("sensor_msgs/msg/Imu", "std_msgs/msg/Float64MultiArray", "std_msgs/msg/UInt8MultiArray")
)


def test_a_sequence_of_numbers_is_an_array_of_pythons():
    message = Numbers(data=[1, 2.5])
    assert message.data == array.array("d", [1.0, 2.5])
    own = array.array("d", [3.0])
    message.data = own
    assert message.data is own
    message.data = (4, 5)
    assert message.data == array.array("d", [4.0, 5.0])
    message.data = array.array("f", [0.5])
    assert (message.data.typecode, list(message.data)) == ("d", [0.5])
    assert Numbers().data == array.array("d")
    assert "data=[4.0" in repr(Numbers(data=[4.0]))
    assert "data=[]" in repr(Numbers())


@pytest.mark.parametrize("value", ["text", [1, "a"], 3, None])
def test_what_is_no_sequence_of_numbers_is_refused(value):
    with pytest.raises(AssertionError, match="The 'data' field must be a set or sequence"):
        Numbers().data = value


@pytest.mark.parametrize("value", [[256], [-1], [1.5]])
def test_a_number_that_a_byte_cannot_hold_is_refused(value):
    with pytest.raises(AssertionError, match="'data'"):
        Bytes(data=value)


def test_an_array_of_numbers_is_one_of_numpy():
    message = Imu()
    assert message.orientation_covariance.tolist() == [0.0] * 9
    message.orientation_covariance = range(9)
    assert message.orientation_covariance.dtype == np.float64
    assert message.orientation_covariance.tolist() == [*map(float, range(9))]
    own = np.arange(9.0)
    message.orientation_covariance = own
    assert message.orientation_covariance is own
    message.orientation_covariance = np.arange(9, dtype=np.float32)
    assert message.orientation_covariance.dtype == np.float64


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ([1.0] * 8, "field must be"),
        (np.zeros(10), r"must have a size of 9"),
        (["a"] * 9, "field must be"),
        (None, "field must be"),
    ],
)
def test_an_array_of_another_length_or_kind_is_refused(value, words):
    with pytest.raises(AssertionError, match=f"The 'orientation_covariance' .*{words}"):
        Imu().orientation_covariance = value


def test_numbers_go_to_the_twin_and_back():
    message = Imu(orientation_covariance=[*range(9)])
    message.angular_velocity.z = 2.5
    wired = to_wire(message)
    assert wired.orientation_covariance.tolist() == [*range(9)]
    assert wired.angular_velocity.z == 2.5
    back = from_wire("sensor_msgs/msg/Imu", wired)
    assert back.orientation_covariance.tolist() == [*range(9)]
    assert isinstance(back.orientation_covariance, np.ndarray)
    assert back == message
    numbers = from_wire("std_msgs/msg/Float64MultiArray", to_wire(Numbers(data=[1.0, -2.0])))
    assert numbers.data == array.array("d", [1.0, -2.0])


def test_messages_with_other_numbers_are_others():
    """As upstream, two arrays differ where all of their numbers do."""
    assert Imu(orientation_covariance=[1.0] * 9) != Imu(orientation_covariance=[2.0] * 9)
    assert Imu(orientation_covariance=[1.0] * 9) == Imu(orientation_covariance=[1.0] * 9)
    assert Numbers(data=[1.0]) != Numbers(data=[2.0])
