"""force_torque_sensor_broadcaster/test/test_force_torque_sensor_broadcaster.cpp on the twin's broadcaster.

The filter chain of upstream's tests is a plugin of its own, which adds 1; state interfaces are not exported here.
"""

from device_harness import ROBOT, Running, setup_of

from drake_twin.controllers.force_torque_sensor_broadcaster import ForceTorqueSensorBroadcaster
from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.parameters import read_parameters
from drake_twin.errors import InputError
from upstream.suite import Suite, refuses

ASSERTIONS = 44
SUITE = Suite("force_torque_sensor_broadcaster/test/test_force_torque_sensor_broadcaster.cpp")

FRAME = "fts_sensor_frame"
VALUES = (1.1, 2.2, 3.3, 4.4, 5.5, 6.6)
AXES = [(vector, axis) for vector in ("force", "torque") for axis in "xyz"]
SENSOR = {"sensor_name": "fts_sensor"}
SOME_NAMES = {"interface_names.force.x": "fts_sensor/force.x", "interface_names.torque.z": "fts_sensor/torque.z"}
ALL_NAMES = {f"interface_names.{vector}.{axis}": f"fts_sensor/{vector}.{axis}" for vector, axis in AXES}
EMPTY_NAMES = dict.fromkeys(SOME_NAMES, "")
OFFSETS = (10.0, 30.0, -50.0, 1.0, -1.2, -5.2)
MULTIPLIERS = (2.0, 0.5, -1.0, -2.0, 3.0, 0.0)
NAN = float("nan")


def per_axis(name, values):
    return {f"{name}.{vector}.{axis}": value for (vector, axis), value in zip(AXES, values, strict=True)}


def broadcaster(given):
    kind = "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster"
    parameters = ControllerParameters("test_force_torque_sensor_broadcaster", kind, {"frame_id": FRAME} | given)
    values, _ = read_parameters(ForceTorqueSensorBroadcaster.Parameters, parameters)
    setup = setup_of(ForceTorqueSensorBroadcaster, values)
    return Running(ForceTorqueSensorBroadcaster(setup), wrench=list(VALUES))


@SUITE.table(
    (
        (130, {}, True),
        (145, SENSOR | SOME_NAMES, True),
        (156, {"sensor_name": ""}, True),
        (168, EMPTY_NAMES, True),
        (182, SENSOR, False),
        (206, SOME_NAMES, False),
    )
)
def names_that_are_refused(given):
    return refuses(lambda: broadcaster(given), InputError)


@SUITE.scenario({186: (), 189: 6, 230: True})
def claims_and_deactivation():
    run = broadcaster(SENSOR)
    yield 186, ForceTorqueSensorBroadcaster.claimed_interfaces(run.controller.setup.parameters, ROBOT)
    yield 189, run.controller.get_sensor_input_port().size()
    run.controller.deactivate(run.context)
    yield 230, run.output("wrench") is None


PUBLISHED = (  # line of the frame, before those of the six values; parameters; values
    (288, SENSOR, VALUES),
    (320, SENSOR | per_axis("offset", OFFSETS), [a + b for a, b in zip(VALUES, OFFSETS, strict=True)]),
    (390, SENSOR | per_axis("multiplier", MULTIPLIERS), [a * b for a, b in zip(VALUES, MULTIPLIERS, strict=True)]),
    (447, SOME_NAMES, (1.1, NAN, NAN, NAN, NAN, 6.6)),
    (489, ALL_NAMES, VALUES),
)
FIRST_VALUE = {390: 393}  # elsewhere on the line after the frame


@SUITE.scenario(
    {line: FRAME for line, *_ in PUBLISHED}
    | {FIRST_VALUE.get(line, line + 1) + n: value for line, _, values in PUBLISHED for n, value in enumerate(values)}
)
def published_messages():
    for line, given, _ in PUBLISHED:
        message = broadcaster(given).output("wrench")
        yield line, message.header.frame_id
        for n, (vector, axis) in enumerate(AXES):
            yield FIRST_VALUE.get(line, line + 1) + n, getattr(getattr(message.wrench, vector), axis)


test_holds_against_upstream = SUITE.test()
