"""The assertions of ros2_controllers' test_battery_state_broadcaster.cpp, cited by line, and the twin's own."""

from math import isnan, nan

import pytest
from controller_parameters import parameters_of
from device_harness import ROBOT, Running, setup_of

from drake_twin import TwinBuilder, messages
from drake_twin.controllers.battery_state_broadcaster import (
    BatteryInterfaces,
    BatteryProperties,
    BatteryStateBroadcaster,
)
from drake_twin.errors import InputError

KIND = "battery_state_broadcaster/BatteryStateBroadcaster"
LIPO = 3
# battery_state_broadcaster_params.yaml
GIVEN = {
    "batteries": ["battery0", "battery1"],
    "interfaces": {
        "battery0": {
            "battery_temperature": True,
            "battery_current": False,
            "battery_charge": True,
            "battery_percentage": False,
            "battery_power_supply_status": True,
            "battery_power_supply_health": True,
            "battery_present": False,
        },
        "battery1": {
            "battery_temperature": True,
            "battery_current": True,
            "battery_charge": True,
            "battery_percentage": True,
            "battery_power_supply_status": True,
            "battery_power_supply_health": True,
            "battery_present": False,
        },
    },
    "battery0": {
        "minimum_voltage": 0.0,
        "maximum_voltage": 10.0,
        "capacity": 12000.0,
        "design_capacity": 13000.0,
        "power_supply_technology": 3,
        "location": "slot0",
        "serial_number": "serial_device_0",
    },
    "battery1": {
        "minimum_voltage": 0.0,
        "maximum_voltage": 15.0,
        "capacity": 17000.0,
        "design_capacity": 18000.0,
        "power_supply_technology": 3,
        "location": "slot1",
        "serial_number": "serial_device_1",
    },
}
# test_battery_state_broadcaster.hpp:158
VALUES = [5.0, 60.0, 6000.0, 3.0, 0.0, 10.0, 80.0, 2000.0, 5000.0, 66.0, 2.0, 4.0]


def broadcaster(values=VALUES, **given):
    parameters = parameters_of(KIND, **(given or GIVEN))
    return Running(BatteryStateBroadcaster(setup_of(BatteryStateBroadcaster, parameters)), values=list(values))


def test_parameters_are_read():
    parameters = parameters_of(KIND, **GIVEN)
    assert parameters.batteries == ("battery0", "battery1")  # :56
    assert parameters.interfaces_of("battery0") == BatteryInterfaces(True, False, True, False, True, True, False)  # :60
    assert parameters.interfaces_of("battery1") == BatteryInterfaces(True, True, True, True, True, True, False)  # :68
    assert parameters.properties_of("battery0") == BatteryProperties(
        0.0, 10.0, 12000.0, 13000.0, 3, "slot0", "serial_device_0"
    )  # :76 to :82
    assert parameters.properties_of("battery1") == BatteryProperties(
        0.0, 15.0, 17000.0, 18000.0, 3, "slot1", "serial_device_1"
    )  # :84 to :90


def test_one_battery_as_before_jazzy():
    parameters = parameters_of(
        KIND, batteries=["battery_state"], battery_state={"design_capacity": 100.0, "power_supply_technology": 2}
    )
    assert parameters.batteries == ("battery_state",)  # :32, :33
    assert parameters.properties_of("battery_state").design_capacity == 100.0  # :36
    assert parameters.properties_of("battery_state").power_supply_technology == 2  # :37


def test_state_interfaces_are_those_that_are_read():
    parameters = parameters_of(KIND, **GIVEN)
    assert BatteryStateBroadcaster.claimed_interfaces(parameters, ROBOT) == ()  # :103, :149
    assert BatteryStateBroadcaster.state_interfaces(parameters) == (  # :106, :152 to :164
        "battery0/battery_voltage",
        "battery0/battery_temperature",
        "battery0/battery_charge",
        "battery0/battery_power_supply_status",
        "battery0/battery_power_supply_health",
        "battery1/battery_voltage",
        "battery1/battery_temperature",
        "battery1/battery_current",
        "battery1/battery_charge",
        "battery1/battery_percentage",
        "battery1/battery_power_supply_status",
        "battery1/battery_power_supply_health",
    )


def test_it_is_activated_and_deactivated():
    run = broadcaster()
    assert run.output("battery_state") is not None  # :130, :176
    run.controller.deactivate(run.context)  # :139
    assert run.output("battery_state") is None
    assert run.output("raw_battery_states") is None


def test_each_battery_is_published():
    run = broadcaster()
    run.advance(0.25)
    message = run.output("raw_battery_states")
    first, second = message.battery_states  # :196
    assert first.header.frame_id == "battery0"  # :200
    assert first.voltage == 5.0  # :201
    assert first.temperature == 60.0  # :202
    assert isnan(first.current)  # :203
    assert first.charge == 6000.0  # :204
    assert first.capacity == 12000.0  # :205
    assert first.design_capacity == 13000.0  # :206
    assert first.percentage == 50.0  # :208
    assert first.power_supply_status == 3  # :209
    assert first.power_supply_health == 0  # :210
    assert first.power_supply_technology == LIPO  # :211
    assert first.present is True  # :212
    assert first.location == "slot0"  # :213
    assert first.serial_number == "serial_device_0"  # :214
    assert second.header.frame_id == "battery1"  # :218
    assert second.voltage == 10.0  # :219
    assert second.temperature == 80.0  # :220
    assert second.current == 2000.0  # :221
    assert second.charge == 5000.0  # :222
    assert second.capacity == 17000.0  # :223
    assert second.design_capacity == 18000.0  # :224
    assert second.percentage == 66.0  # :225
    assert second.power_supply_status == 2  # :226
    assert second.power_supply_health == 4  # :227
    assert second.power_supply_technology == LIPO  # :228
    assert second.present is True  # :229
    assert second.location == "slot1"  # :230
    assert second.serial_number == "serial_device_1"  # :231
    assert second.header.stamp.nanosec == 250_000_000
    assert messages.type_store().serialize_cdr(message, message.__msgtype__)


def test_all_batteries_together_are_published():
    message = broadcaster().output("battery_state")
    assert message.header.frame_id == ""  # :234
    assert message.voltage == 7.5  # :235
    assert message.temperature == 70.0  # :236
    assert message.current == 2000.0  # :237
    assert message.charge == 11000.0  # :238
    assert message.capacity == 29000.0  # :98, :239
    assert message.design_capacity == 31000.0  # :99, :240
    assert message.percentage == 58.0  # :241
    assert message.power_supply_status == 3  # :242
    assert message.power_supply_health == 4  # :243
    assert message.power_supply_technology == LIPO  # :244
    assert message.present is True  # :245
    assert message.location == "slot0, slot1, "  # :246
    assert message.serial_number == "serial_device_0, serial_device_1, "  # :247
    assert messages.type_store().serialize_cdr(message, message.__msgtype__)


def test_a_new_voltage_changes_the_percentage():
    run = broadcaster()
    run.fix("values", [10.0, *VALUES[1:]])  # :257
    first, second = run.output("raw_battery_states").battery_states  # :263
    assert (first.voltage, first.percentage, first.present) == (10.0, 100.0, True)  # :267, :269, :270
    assert (second.voltage, second.percentage, second.present) == (10.0, 66.0, True)  # :274 to :276
    message = run.output("battery_state")
    assert (message.voltage, message.percentage, message.present) == (10.0, 83.0, True)  # :279 to :281


def test_a_voltage_that_is_nan_is_no_battery():
    run = broadcaster([nan, *VALUES[1:]])  # :291
    first, second = run.output("raw_battery_states").battery_states  # :297
    assert isnan(first.voltage)  # :301
    assert isnan(first.percentage)  # :302
    assert first.present is False  # :303
    assert (second.voltage, second.percentage, second.present) == (10.0, 66.0, True)  # :307 to :309
    message = run.output("battery_state")
    assert isnan(message.voltage)  # :312
    assert isnan(message.percentage)  # :313
    assert message.present is True  # :314


def test_batteries_of_two_chemistries_are_of_none():
    other = {**GIVEN, "battery1": {**GIVEN["battery1"], "power_supply_technology": 2}}
    assert broadcaster(**other).output("battery_state").power_supply_technology == 0


def test_the_presence_may_be_read():
    given = {"batteries": ["b"], "interfaces": {"b": {"battery_present": True}}}
    assert broadcaster([12.0, 0.0], **given).output("raw_battery_states").battery_states[0].present is False
    assert broadcaster([12.0, 1.0], **given).output("raw_battery_states").battery_states[0].present is True
    assert broadcaster([12.0, nan], **given).output("raw_battery_states").battery_states[0].present is False


def test_a_single_sensor_has_a_voltage():
    run = broadcaster([12.5], sensor_name="battery", design_capacity=7.0, power_supply_technology=2)
    assert BatteryStateBroadcaster.state_interfaces(run.controller.setup.parameters) == ("battery/voltage",)
    message = run.output("battery_state")
    assert (message.voltage, message.design_capacity, message.power_supply_technology) == (12.5, 7.0, 2)
    assert (isnan(message.percentage), message.present, message.capacity) == (True, True, 0.0)
    assert run.output("raw_battery_states").battery_states == []


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({}, "batteries or sensor_name is needed, and neither is given"),
        ({"batteries": ["a"], "sensor_name": "b"}, "batteries or sensor_name is needed, and not both"),
        ({"batteries": ["a", "a"]}, "batteries has a name twice: a, a"),
        (
            {"batteries": ["a"], "a": {"minimum_voltage": 4.0, "maximum_voltage": 4.0}},
            r"maximum_voltage \(4\) is not above minimum_voltage \(4\)",
        ),
        ({"batteries": ["a"], "a": {"power_supply_technology": 9}}, "9 is above 8"),
    ],
)
def test_wrong_parameters_are_refused(given, text):
    with pytest.raises(InputError, match=text):
        parameters_of(KIND, **given)


def test_parameters_of_a_battery_that_is_not_listed_are_said():
    run = broadcaster([1.0], batteries=["a"], interfaces={"b": {"battery_charge": True}})
    assert run.controller.warnings == ("the parameters of 'b' are ignored: it is not in batteries",)


ROBOT_WITH_BATTERY = """<robot name="r">
  <link name="base"><inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <ros2_control name="s" type="sensor">
    <hardware><plugin>mock_components/GenericSystem</plugin></hardware>
    <sensor name="main">
      <state_interface name="battery_voltage"><param name="initial_value">11.5</param></state_interface>
      <state_interface name="battery_current"/>
      <state_interface name="battery_present" data_type="bool">
        <param name="initial_value">VALUE</param></state_interface>
    </sensor>
  </ros2_control>
</robot>"""


def battery(tmp_path, interfaces, value="true"):
    file = tmp_path / "r.urdf"
    file.write_text(ROBOT_WITH_BATTERY.replace("VALUE", value))
    given = {"batteries": ["main"], "interfaces": {"main": interfaces}}
    return TwinBuilder().robot("r", file).controller("r", "battery", KIND, given).build()


def test_in_a_twin_the_values_are_those_of_mock_hardware(tmp_path):
    twin = battery(tmp_path, {"battery_current": True, "battery_present": True})
    twin.advance_to(0.02)
    message = twin.latest("/r/battery/battery_state")
    (only,) = twin.latest("/r/battery/raw_battery_states").battery_states
    assert (message.voltage, only.voltage, only.present) == (11.5, 11.5, True)
    assert isnan(only.current)
    assert [str(item) for item in twin.findings if "battery" in str(item) or "state_interface" in str(item)] == []


def test_in_a_twin_a_state_interface_that_the_file_lacks_is_said(tmp_path):
    twin = battery(tmp_path, {"battery_charge": True})
    (finding,) = [str(item) for item in twin.findings if "battery_charge" in str(item)]
    assert "<ros2_control> has no state interface main/battery_charge" in finding
    assert "main/battery_voltage, main/battery_current, main/battery_present" in finding


def test_an_initial_value_that_is_no_number_is_refused_with_its_line(tmp_path):
    with pytest.raises(InputError, match="initial_value is 'full', which is not a number") as raised:
        battery(tmp_path, {}, "full")
    assert raised.value.line == 10
