"""The assertions of ros2_controllers' test_gps_sensor_broadcaster.cpp, cited by line, and the twin's own."""

from math import isnan, nan

import pytest
from controller_parameters import parameters_of
from device_harness import Running, setup_of

from drake_twin import messages
from drake_twin.controllers.gps_sensor_broadcaster import GPSSensorBroadcaster
from drake_twin.errors import InputError

KIND = "gps_sensor_broadcaster/GPSSensorBroadcaster"
VALUES = [1.0, 1.0, 1.1, 2.2, 3.3]
VARIANCES = [0.5, 0.7, 0.9]
STATIC = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]


def broadcaster(values=VALUES, **more):
    parameters = parameters_of(KIND, sensor_name="gps_sensor", frame_id="gps_sensor_frame", **more)
    return Running(GPSSensorBroadcaster(setup_of(GPSSensorBroadcaster, parameters)), values=list(values))


@pytest.mark.parametrize("given", [{}, {"sensor_name": "gps_sensor"}, {"sensor_name": "", "frame_id": "f"}])
def test_sensor_and_frame_are_required(given):  # :171, :179
    with pytest.raises(InputError, match=r"is missing|is empty"):
        parameters_of(KIND, **given)


def test_it_is_activated_and_deactivated():  # :190 to :194
    run = broadcaster()
    assert run.output("gps/fix") is not None
    run.controller.deactivate(run.context)
    assert run.output("gps/fix") is None


@pytest.mark.parametrize(
    ("given", "variances", "covariance", "kind"),
    [
        ({}, [], [0.0] * 9, 3),  # :221
        ({"static_position_covariance": STATIC}, [], STATIC, 3),  # :252, :253
        ({"read_covariance_from_interface": True}, VARIANCES, [0.5, 0, 0, 0, 0.7, 0, 0, 0, 0.9], 2),  # :283, :284
    ],
)
def test_each_value_stands_in_its_field(given, variances, covariance, kind):
    run = broadcaster([*VALUES, *variances], **given)
    run.advance(0.25)
    message = run.output("gps/fix")
    assert message.header.frame_id == "gps_sensor_frame"  # :213, :245, :274
    assert message.status.status == 1  # :214, :246, :275
    assert message.status.service == 1  # :215, :247, :276
    assert message.latitude == 1.1  # :216, :248, :277
    assert message.longitude == 2.2  # :217, :249, :278
    assert message.altitude == 3.3  # :218, :250, :279
    assert message.position_covariance.tolist() == covariance
    assert message.position_covariance_type == kind
    assert message.header.stamp.nanosec == 250_000_000
    assert messages.type_store().serialize_cdr(message, message.__msgtype__)


def test_the_state_interfaces_are_those_of_the_semantic_component():
    parameters = parameters_of(KIND, sensor_name="g", frame_id="f", read_covariance_from_interface=True)
    assert GPSSensorBroadcaster.state_interfaces(parameters) == tuple(
        f"g/{name}"
        for name in (
            "status",
            "service",
            "latitude",
            "longitude",
            "altitude",
            "latitude_covariance",
            "longitude_covariance",
            "altitude_covariance",
        )
    )


def test_a_status_that_nobody_sets_is_unknown():
    message = broadcaster([nan] * 5).output("gps/fix")
    assert (message.status.status, message.status.service) == (-2, 0)
    assert isnan(message.latitude)
    assert messages.type_store().serialize_cdr(message, message.__msgtype__)


def test_status_and_service_are_whole_numbers():
    message = broadcaster([-1.0, 8.0, 0.0, 0.0, 0.0]).output("gps/fix")
    assert (message.status.status, message.status.service) == (-1, 8)
    assert isinstance(message.status.status, int)


def test_a_covariance_has_nine_numbers():
    with pytest.raises(InputError, match="static_position_covariance has 3 numbers, where nine are needed"):
        broadcaster(static_position_covariance=[1.0, 2.0, 3.0])
