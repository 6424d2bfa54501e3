from dataclasses import replace

import numpy as np
import pytest
from device_harness import ROBOT, Running, setup_of

from drake_twin import messages
from drake_twin.controllers.imu_sensor_broadcaster import IMUSensorBroadcaster, IMUSensorBroadcasterParameters
from drake_twin.errors import InputError

SPATIAL = [0.5, -0.5, 0.5, -0.5, 1.0, 2.0, 3.0, 0.1, 0.2, 9.81]
PARAMETERS = IMUSensorBroadcasterParameters(
    "imu", "palm", static_covariance_angular_velocity=tuple(float(n) for n in range(9))
)


def broadcaster(parameters=PARAMETERS, **more):
    return Running(IMUSensorBroadcaster(setup_of(IMUSensorBroadcaster, parameters, **more)), spatial=SPATIAL)


def test_each_value_stands_in_its_field():
    run = broadcaster()
    run.advance(1.5)
    message = run.output("imu")
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1, 500_000_000)
    quaternion = message.orientation
    assert [quaternion.w, quaternion.x, quaternion.y, quaternion.z] == SPATIAL[:4]
    for vector, values in ((message.angular_velocity, SPATIAL[4:7]), (message.linear_acceleration, SPATIAL[7:])):
        assert [vector.x, vector.y, vector.z] == values
    assert message.angular_velocity_covariance.tolist() == list(range(9))
    assert message.orientation_covariance.tolist() == [0.0] * 9
    store = messages.type_store()
    assert store.serialize_cdr(message, "sensor_msgs/msg/Imu")


def test_the_frame_of_a_link_gets_the_robots_prefix_and_any_other_frame_stays():
    assert broadcaster(frame_prefix="robot_1/").output("imu").header.frame_id == "robot_1/palm"
    parameters = replace(PARAMETERS, frame_id="imu_frame")
    assert broadcaster(parameters, frame_prefix="robot_1/").output("imu").header.frame_id == "imu_frame"


def test_an_inactive_broadcaster_has_no_message():
    run = broadcaster()
    run.controller.deactivate(run.context)
    assert run.output("imu") is None
    run.controller.activate(run.context)
    assert run.output("imu") is not None


def test_it_claims_nothing_and_writes_nothing():
    assert IMUSensorBroadcaster.claimed_interfaces(PARAMETERS, ROBOT) == ()
    assert not broadcaster().controller.HasOutputPort("command_interfaces")
    assert IMUSensorBroadcaster.sensor_name(PARAMETERS) == "imu"


def test_it_costs_no_event():
    run = broadcaster()
    run.advance(1.0)
    assert run.simulator.get_num_unrestricted_updates() == 0


def test_a_message_already_published_does_not_change():
    run = broadcaster()
    first = run.output("imu")
    run.fix("spatial", list(np.zeros(10)))
    run.advance(0.5)
    assert first.angular_velocity.z == 3.0
    assert run.output("imu").angular_velocity.z == 0.0


def test_a_covariance_has_nine_numbers():
    with pytest.raises(InputError, match="'dut': static_covariance_orientation has 3 numbers, where nine are needed"):
        broadcaster(replace(PARAMETERS, static_covariance_orientation=(1.0, 2.0, 3.0)))
