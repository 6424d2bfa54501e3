from dataclasses import replace

import numpy as np
import pytest

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.joint_state_broadcaster import (
    JointStateBroadcaster,
    JointStateBroadcasterParameters,
    JointStateInterfaceMap,
)
from drake_twin.description.robot_description import (
    ControlledJoint,
    HardwareSystem,
    Joint,
    RobotDescription,
    StateInterface,
)
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.systems.no_message import or_none

# A floating base (7 positions, 6 velocities), then two joints whose actuators stand in the other order.
LAYOUT = StateLayout(
    size=17,
    positions={"a": 7, "b": 8},
    velocities={"a": 15, "b": 16},
    efforts={"b": 0, "a": 1},
    num_actuators=2,
    base_position=0,
    base_velocity=9,
)
ALL = ("position", "velocity", "effort")


def broadcaster(interfaces, layout, parameters=None, frame_id=""):
    """A broadcaster of a robot whose ``<ros2_control>`` tag has these state interfaces."""
    joints = tuple(
        ControlledJoint(joint, state_interfaces=tuple(StateInterface(name) for name in names))
        for joint, names in interfaces.items()
    )
    parameters = replace(parameters or JointStateBroadcasterParameters(), frame_id=frame_id)
    description = RobotDescription(
        "robot",
        ("base", "link"),
        tuple(Joint(name, "continuous", "base", "link") for name in layout.positions),
        systems=(HardwareSystem("system", "system", "plugin", joints),),
    )
    return JointStateBroadcaster(ControllerSetup("broadcaster", parameters, (), description, layout))


@pytest.fixture
def state():
    return np.arange(17.0)


def evaluate(dut, state, port="joint_states", time=0.0):
    context = dut.CreateDefaultContext()
    context.SetTime(time)
    dut.get_state_input_port().FixValue(context, state)
    dut.get_net_actuation_input_port().FixValue(context, [100.0, 200.0])
    return or_none(dut.GetOutputPort(port).Eval(context))


def test_joints_come_in_the_order_of_ros2_control_with_their_own_values(state):
    message = evaluate(broadcaster({"b": ALL, "a": ALL}, LAYOUT), state)
    assert message.name == ["b", "a"]
    assert message.position.tolist() == [8, 7]
    assert message.velocity.tolist() == [16, 15]
    assert message.effort.tolist() == [100, 200]


def test_what_a_joint_has_no_state_interface_for_is_nan(state):
    message = evaluate(broadcaster({"a": ("position",), "b": ("velocity",)}, LAYOUT), state)
    assert message.position[0] == 7
    assert message.velocity[1] == 16
    assert np.isnan([message.position[1], message.velocity[0], *message.effort]).all()


def test_the_stamp_is_simulation_time_to_the_nanosecond(state):
    stamp = evaluate(broadcaster({"a": ALL}, LAYOUT), state, time=3.000000001).header.stamp
    assert (stamp.sec, stamp.nanosec) == (3, 1)


def test_dynamic_joint_states_list_each_joints_own_interfaces(state):
    dut = broadcaster({"b": ("effort", "position"), "a": ("velocity",)}, LAYOUT)
    message = evaluate(dut, state, "dynamic_joint_states")
    assert message.joint_names == ["b", "a"]
    assert [list(item.interface_names) for item in message.interface_values] == [["effort", "position"], ["velocity"]]
    assert [item.values.tolist() for item in message.interface_values] == [[100.0, 8.0], [15.0]]


def test_a_message_already_published_does_not_change_when_time_goes_on(state):
    dut = broadcaster({"a": ALL}, LAYOUT)
    context = dut.CreateDefaultContext()
    port = dut.get_state_input_port().FixValue(context, state)
    dut.get_net_actuation_input_port().FixValue(context, [0.0, 0.0])
    first = dut.get_joint_states_output_port().Eval(context)
    port.GetMutableData().get_mutable_value().set_value(state + 1.0)
    context.SetTime(1.0)
    second = dut.get_joint_states_output_port().Eval(context)
    assert (first.position[0], second.position[0]) == (7.0, 8.0)


def test_messages_serialise_to_ros_wire_format_and_back(state):
    from drake_twin.messages import type_store

    store = type_store()
    dut = broadcaster({"b": ALL, "a": ALL}, LAYOUT)
    for port, name in (
        ("joint_states", "sensor_msgs/msg/JointState"),
        ("dynamic_joint_states", "control_msgs/msg/DynamicJointState"),
    ):
        message = evaluate(dut, state, port, time=1.5)
        again = store.deserialize_cdr(store.serialize_cdr(message, name), name)
        assert again.header.stamp.nanosec == 500_000_000


def broadcast(state, of_robot, port="joint_states", **parameters):
    parameters = JointStateBroadcasterParameters(**parameters)
    return evaluate(broadcaster(of_robot, LAYOUT, parameters, "robot_1/base_link"), state, port)


def test_conformance_broadcaster_order_is_that_of_the_parameter_joints(state):
    interfaces = {"b": ALL, "a": ALL}
    message = broadcast(state, interfaces, joints=("a", "b"), interfaces=("position",))
    assert message.name == ["a", "b"]
    assert message.position.tolist() == [7, 8]
    assert broadcast(state, interfaces).name == ["b", "a"]


def test_conformance_broadcaster_missing_values_are_nan(state):
    interfaces = {"b": ("velocity",), "a": ALL}
    message = broadcast(state, interfaces, joints=("a", "b", "c"), interfaces=("position", "velocity"))
    np.testing.assert_array_equal(message.position, [7, np.nan, np.nan])
    np.testing.assert_array_equal(message.velocity, [15, 16, np.nan])
    assert np.isnan(message.effort).all()
    dynamic = broadcast(
        state, interfaces, "dynamic_joint_states", joints=("a", "b", "c"), interfaces=("position", "velocity")
    )
    names = [list(item.interface_names) for item in dynamic.interface_values]
    assert names == [["position", "velocity"], ["velocity"], ["position", "velocity"]]
    np.testing.assert_array_equal(
        np.concatenate([item.values for item in dynamic.interface_values]), [7, 15, 16, np.nan, np.nan]
    )


@pytest.mark.parametrize("only", [{"joints": ("a",)}, {"interfaces": ("position",)}])
def test_joints_or_interfaces_alone_choose_nothing(state, only):
    message = broadcast(state, {"b": ALL, "a": ALL}, **only)
    assert message.name == ["b", "a"]
    assert message.velocity.tolist() == [16, 15]


def test_extra_joints_come_last_and_are_zero_unless_the_robot_has_them(state):
    message = broadcast(state, {"b": ALL, "a": ALL}, extra_joints=("tail", "a"))
    assert message.name == ["b", "a", "tail"]
    assert [message.position[2], message.velocity[2], message.effort[2]] == [0, 0, 0]
    assert message.position[1] == 7
    dynamic = broadcast(state, {"a": ALL}, "dynamic_joint_states", extra_joints=("tail",))
    assert dynamic.joint_names == ["a", "tail"]
    assert dynamic.interface_values[1].values.tolist() == [0, 0, 0]


def test_a_state_interface_of_another_name_is_published_as_the_field_it_is_mapped_to(state):
    own = JointStateInterfaceMap(effort="current")
    interfaces = {"a": ("position", "current")}
    dynamic = broadcast(state, interfaces, "dynamic_joint_states", map_interface_to_joint_state=own)
    assert list(dynamic.interface_values[0].interface_names) == ["position", "effort"]
    # A mapped interface that the twin has no value for does not hide the one that it has.
    message = broadcast(state, {"a": ("position", "raw")}, map_interface_to_joint_state=JointStateInterfaceMap("raw"))
    assert message.position.tolist() == [7]


def test_a_joint_with_other_interfaces_only_is_in_the_dynamic_message_alone(state):
    interfaces = {"b": ("temperature",), "a": ALL}
    assert broadcast(state, interfaces).name == ["a"]
    dynamic = broadcast(state, interfaces, "dynamic_joint_states")
    assert dynamic.joint_names == ["b", "a"]
    assert np.isnan(dynamic.interface_values[0].values).all()


def test_the_headers_have_the_frame_and_the_dynamic_message_can_be_turned_off(state):
    assert broadcast(state, {"a": ALL}).header.frame_id == "robot_1/base_link"
    assert broadcast(state, {"a": ALL}, "dynamic_joint_states").header.frame_id == "robot_1/base_link"
    assert broadcast(state, {"a": ALL}, "dynamic_joint_states", publish_dynamic_joint_states=False) is None
