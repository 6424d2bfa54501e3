"""The assertions of ros2_controllers' test_magnetometer_broadcaster.cpp, cited by line, and the twin's own."""

import pytest
from controller_parameters import parameters_of
from device_harness import Running, setup_of

from drake_twin import messages
from drake_twin.controllers.magnetometer_broadcaster import MagnetometerBroadcaster
from drake_twin.errors import InputError

KIND = "magnetometer_broadcaster/MagnetometerBroadcaster"
FIELD = [20e-6, 30e-6, 40e-6]


def broadcaster(**more):
    parameters = parameters_of(KIND, sensor_name="magnetometer", frame_id="magnetometer_frame", **more)
    return Running(MagnetometerBroadcaster(setup_of(MagnetometerBroadcaster, parameters)), values=FIELD)


@pytest.mark.parametrize("given", [{}, {"sensor_name": "magnetometer"}, {"sensor_name": "", "frame_id": "f"}])
def test_sensor_and_frame_are_required(given):  # :134, :142
    with pytest.raises(InputError, match=r"is missing|is empty"):
        parameters_of(KIND, **given)


def test_it_is_activated_and_deactivated():  # :153 to :155
    run = broadcaster()
    assert run.output("magnetic_field") is not None
    run.controller.deactivate(run.context)
    assert run.output("magnetic_field") is None


@pytest.mark.parametrize(
    ("given", "covariance"),
    [
        ({}, [0.0] * 9),  # :176
        ({"static_covariance": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]}, [1, 0, 0, 0, 1, 0, 0, 0, 1]),  # :202
    ],
)
def test_each_value_stands_in_its_field(given, covariance):
    run = broadcaster(**given)
    run.advance(0.25)
    message = run.output("magnetic_field")
    assert message.header.frame_id == "magnetometer_frame"  # :170, :197
    assert message.magnetic_field.x == 20e-6  # :171, :198
    assert message.magnetic_field.y == 30e-6  # :172, :199
    assert message.magnetic_field.z == 40e-6  # :173, :200
    assert message.magnetic_field_covariance.tolist() == covariance
    assert message.header.stamp.nanosec == 250_000_000
    assert messages.type_store().serialize_cdr(message, message.__msgtype__)


def test_the_state_interfaces_are_those_of_the_semantic_component():
    parameters = parameters_of(KIND, sensor_name="m", frame_id="f")
    assert MagnetometerBroadcaster.state_interfaces(parameters) == (
        "m/magnetic_field.x",
        "m/magnetic_field.y",
        "m/magnetic_field.z",
    )


def test_a_covariance_has_nine_numbers():
    with pytest.raises(InputError, match="static_covariance has 3 numbers, where nine are needed"):
        broadcaster(static_covariance=[1.0, 2.0, 3.0])
