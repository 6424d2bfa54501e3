"""imu_sensor_broadcaster/test/test_imu_sensor_broadcaster.cpp on the twin's broadcaster."""

from device_harness import ROBOT, Running, setup_of

from drake_twin.controllers.imu_sensor_broadcaster import IMUSensorBroadcaster, IMUSensorBroadcasterParameters
from upstream.suite import Suite

ASSERTIONS = 17
SUITE = Suite("imu_sensor_broadcaster/test/test_imu_sensor_broadcaster.cpp")

VALUES = (0.1826, 0.3651, 0.5477, 0.7303, 5.5, 6.6, 7.7, 8.8, 9.9, 10.10)
PARAMETERS = IMUSensorBroadcasterParameters("imu_sensor", "imu_sensor_frame")


@SUITE.scenario(
    {161: (), 164: 10, 230: "imu_sensor_frame"}
    | dict(zip(range(231, 241), VALUES, strict=True))
    | dict.fromkeys((244, 245, 246), [0.0] * 9)
)
def published_message():
    yield 161, IMUSensorBroadcaster.claimed_interfaces(PARAMETERS, ROBOT)
    x, y, z, w, *others = VALUES
    run = Running(IMUSensorBroadcaster(setup_of(IMUSensorBroadcaster, PARAMETERS)), spatial=[w, x, y, z, *others])
    yield 164, run.controller.get_sensor_input_port().size()
    message = run.output("imu")
    yield 230, message.header.frame_id
    line = 231
    for part, axes in (("orientation", "xyzw"), ("angular_velocity", "xyz"), ("linear_acceleration", "xyz")):
        for axis in axes:
            yield line, getattr(getattr(message, part), axis)
            line += 1
    yield 244, message.orientation_covariance.tolist()
    yield 245, message.angular_velocity_covariance.tolist()
    yield 246, message.linear_acceleration_covariance.tolist()


@SUITE.scenario({189: True})
def deactivated():
    run = Running(IMUSensorBroadcaster(setup_of(IMUSensorBroadcaster, PARAMETERS)), spatial=[1.0, *[0.0] * 9])
    run.controller.deactivate(run.context)
    yield 189, run.output("imu") is None


test_holds_against_upstream = SUITE.test()
