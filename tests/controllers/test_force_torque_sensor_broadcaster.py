from math import exp, pi

import numpy as np
import pytest
from device_harness import Running, setup_of

from drake_twin import messages
from drake_twin.controllers.force_torque_sensor_broadcaster import (
    AxisMultipliers,
    AxisNames,
    AxisOffsets,
    ForceTorqueSensorBroadcaster,
    ForceTorqueSensorBroadcasterParameters,
    WrenchFilter,
    WrenchFilterParameters,
    WrenchInterfaceNames,
    WrenchMultipliers,
    WrenchOffsets,
)
from drake_twin.errors import InputError

WRENCH = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
LOW_PASS = WrenchFilter("control_filters/LowPassFilterWrench", WrenchFilterParameters(100.0, 5.0, 0.0))


def broadcaster(**parameters):
    parameters = ForceTorqueSensorBroadcasterParameters("finger_link", **parameters)
    setup = setup_of(ForceTorqueSensorBroadcaster, parameters)
    return Running(ForceTorqueSensorBroadcaster(setup), wrench=WRENCH)


def values(message):
    force, torque = message.wrench.force, message.wrench.torque
    return [force.x, force.y, force.z, torque.x, torque.y, torque.z]


def test_each_value_stands_in_its_field():
    run = broadcaster(sensor_name="fts")
    run.advance(0.25)
    message = run.output("wrench")
    assert values(message) == WRENCH
    assert (message.header.frame_id, message.header.stamp.nanosec) == ("finger_link", 250_000_000)
    assert messages.type_store().serialize_cdr(message, "geometry_msgs/msg/WrenchStamped")


def test_the_offset_is_added_before_the_multiplication():
    offset = WrenchOffsets(force=AxisOffsets(z=-1.0), torque=AxisOffsets(x=10.0))
    multiplier = WrenchMultipliers(force=AxisMultipliers(z=3.0), torque=AxisMultipliers(y=-1.0))
    run = broadcaster(sensor_name="fts", offset=offset, multiplier=multiplier)
    assert values(run.output("wrench")) == [1.0, 2.0, (3.0 - 1.0) * 3.0, 14.0, -5.0, 6.0]


def test_an_axis_without_a_state_interface_is_nan():
    names = WrenchInterfaceNames(force=AxisNames(x="fts/force.x"), torque=AxisNames(z="fts/torque.z"))
    run = broadcaster(interface_names=names)
    np.testing.assert_array_equal(values(run.output("wrench")), [1.0, *[np.nan] * 4, 6.0])
    assert ForceTorqueSensorBroadcaster.sensor_name(run.controller.setup.parameters) == "fts"


def test_either_a_sensor_or_interfaces_have_to_be_named():
    names = WrenchInterfaceNames(force=AxisNames(x="fts/force.x"))
    with pytest.raises(InputError, match="sensor_name or interface_names is needed, and not both"):
        broadcaster(sensor_name="fts", interface_names=names)
    with pytest.raises(InputError, match="sensor_name or interface_names is needed, and neither is given"):
        broadcaster()
    names = WrenchInterfaceNames(force=AxisNames(x="fts/forces.x"))
    with pytest.raises(InputError, match=r"'fts/forces.x' is not an interface .* Did you mean 'force.x'"):
        broadcaster(interface_names=names)


def test_a_broadcaster_without_filters_has_no_event_and_no_filtered_message():
    run = broadcaster(sensor_name="fts")
    run.advance(1.0)
    assert run.simulator.get_num_unrestricted_updates() == 0
    assert run.output("wrench_filtered") is None


def test_a_step_comes_through_the_filter_as_the_closed_form_says():
    run = broadcaster(sensor_name="fts", sensor_filter_chain={"filter1": LOW_PASS})
    run.fix("wrench", [0.0] * 6)
    run.advance(0.095)
    run.fix("wrench", WRENCH)
    run.advance(0.195)  # updates at 0.10, …, 0.19; the first of them takes the step in, the other nine let it out
    message = run.output("wrench_filtered")
    np.testing.assert_allclose(values(message), (1 - exp(-2 * pi * 5 / 100 * 9)) * np.array(WRENCH), rtol=1e-12)
    assert message.header.stamp.nanosec == 190_000_000
    assert values(run.output("wrench")) == WRENCH


def test_filters_follow_each_other_by_their_number_and_begin_anew_at_activation():
    stronger = WrenchFilter(LOW_PASS.type, WrenchFilterParameters(100.0, 1.0, 0.0))
    run = broadcaster(sensor_name="fts", sensor_filter_chain={"filter10": stronger, "filter9": LOW_PASS})
    assert [item.damping_frequency for item in run.controller._filters] == [5.0, 1.0]
    run.fix("wrench", [0.0] * 6)
    run.advance(0.5)
    run.controller.deactivate(run.context)
    assert run.output("wrench_filtered") is None
    run.controller.activate(run.context)
    run.fix("wrench", WRENCH)
    run.advance(0.6)
    np.testing.assert_allclose(values(run.output("wrench_filtered")), WRENCH, rtol=1e-12)


def test_a_filter_that_fails_stops_the_broadcaster_and_nothing_else(monkeypatch):
    run = broadcaster(sensor_name="fts", sensor_filter_chain={"filter1": LOW_PASS})
    run.fix("wrench", WRENCH)
    run.advance(0.05)
    monkeypatch.setattr(run.controller, "_filtered", lambda *_: 1 / 0)
    run.advance(0.1)
    assert run.controller.fault(run.context).startswith("ZeroDivisionError: division by zero (")
