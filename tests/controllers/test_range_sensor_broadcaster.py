"""The assertions of ros2_controllers' test_range_sensor_broadcaster.cpp, cited by line, and the twin's own values."""

import numpy as np
import pytest
from controller_parameters import parameters_of
from device_harness import ROBOT, Running, setup_of

from drake_twin import messages
from drake_twin.controllers.range_sensor_broadcaster import RangeSensorBroadcaster
from drake_twin.errors import InputError

KIND = "range_sensor_broadcaster/RangeSensorBroadcaster"
# range_sensor_broadcaster_params.yaml
GIVEN = {
    "sensor_name": "range_sensor",
    "frame_id": "range_sensor_frame",
    "radiation_type": 1,
    "field_of_view": 0.1,
    "min_range": 0.10,
    "max_range": 7.0,
    "variance": 1.0,
}


def broadcaster(value=3.1):
    parameters = parameters_of(KIND, **GIVEN)
    return Running(RangeSensorBroadcaster(setup_of(RangeSensorBroadcaster, parameters)), values=[value])


@pytest.mark.parametrize("name", ["sensor_name", "frame_id"])  # :132, :144
def test_an_empty_name_is_refused(name):
    with pytest.raises(InputError, match=f"{name} is empty"):
        parameters_of(KIND, **{**GIVEN, name: ""})


def test_it_reads_one_state_interface_and_claims_none():
    parameters = parameters_of(KIND, **GIVEN)
    assert RangeSensorBroadcaster.claimed_interfaces(parameters, ROBOT) == ()  # :156, :171, :181
    assert RangeSensorBroadcaster.state_interfaces(parameters) == ("range_sensor/range",)  # :158, :174, :184


def test_it_is_activated_and_deactivated():
    run = broadcaster()
    assert run.output("range") is not None  # :167, :198
    run.controller.deactivate(run.context)  # :177
    assert run.output("range") is None
    assert run.controller.fault(run.context) is None


# :211 to :218 (3.1 m), :235 to :242 (0.1 m), :249 to :256 (4.0 m); out of bounds :273 to :281 (0 m), :288 to :296 (6 m)
@pytest.mark.parametrize("value", [3.1, 0.10, 4.0, 0.0, 6.0])
def test_a_range_is_published_as_it_is(value):
    run = broadcaster(value)
    run.advance(1.5)
    message = run.output("range")
    assert message.header.frame_id == "range_sensor_frame"
    assert message.range == value
    assert message.radiation_type == 1
    assert message.field_of_view == 0.1
    assert message.min_range == 0.1
    assert message.max_range == 7.0
    assert message.variance == 1.0
    assert message.header.stamp.nanosec == 500_000_000
    store = messages.type_store()
    again = store.deserialize_cdr(store.serialize_cdr(message, message.__msgtype__), message.__msgtype__)
    assert np.float32(again.range) == np.float32(value)


def test_the_defaults_are_those_of_upstream():
    parameters = parameters_of(KIND, sensor_name="s", frame_id="f")
    assert (parameters.radiation_type, parameters.field_of_view) == (0, 0.52)
    assert (parameters.min_range, parameters.max_range, parameters.variance) == (0.52, 4.0, 0.0)
