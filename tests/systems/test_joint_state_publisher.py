import numpy as np
import pytest

from drake_twin.systems.joint_state_publisher import JointStatePublisher
from drake_twin.systems.state_layout import StateLayout

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


@pytest.fixture
def state():
    return np.arange(17.0)


def evaluate(dut, state, port="joint_states", time=0.0):
    context = dut.CreateDefaultContext()
    context.SetTime(time)
    dut.get_state_input_port().FixValue(context, state)
    dut.get_net_actuation_input_port().FixValue(context, [100.0, 200.0])
    return dut.GetOutputPort(port).Eval(context)


def test_joints_come_in_the_order_of_ros2_control_with_their_own_values(state):
    message = evaluate(JointStatePublisher({"b": ALL, "a": ALL}, LAYOUT), state)
    assert message.name == ["b", "a"]
    assert message.position.tolist() == [8, 7]
    assert message.velocity.tolist() == [16, 15]
    assert message.effort.tolist() == [100, 200]


def test_what_a_joint_has_no_state_interface_for_is_nan(state):
    message = evaluate(JointStatePublisher({"a": ("position",), "b": ("velocity",)}, LAYOUT), state)
    assert message.position[0] == 7
    assert message.velocity[1] == 16
    assert np.isnan([message.position[1], message.velocity[0], *message.effort]).all()


def test_the_stamp_is_simulation_time_to_the_nanosecond(state):
    stamp = evaluate(JointStatePublisher({"a": ALL}, LAYOUT), state, time=3.000000001).header.stamp
    assert (stamp.sec, stamp.nanosec) == (3, 1)


def test_dynamic_joint_states_list_each_joints_own_interfaces(state):
    dut = JointStatePublisher({"b": ("effort", "position"), "a": ("velocity",)}, LAYOUT)
    message = evaluate(dut, state, "dynamic_joint_states")
    assert message.joint_names == ["b", "a"]
    assert [list(item.interface_names) for item in message.interface_values] == [["effort", "position"], ["velocity"]]
    assert [item.values.tolist() for item in message.interface_values] == [[100.0, 8.0], [15.0]]


def test_a_message_already_published_does_not_change_when_time_goes_on(state):
    dut = JointStatePublisher({"a": ALL}, LAYOUT)
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
    dut = JointStatePublisher({"b": ALL, "a": ALL}, LAYOUT)
    for port, name in (
        ("joint_states", "sensor_msgs/msg/JointState"),
        ("dynamic_joint_states", "control_msgs/msg/DynamicJointState"),
    ):
        message = evaluate(dut, state, port, time=1.5)
        again = store.deserialize_cdr(store.serialize_cdr(message, name), name)
        assert again.header.stamp.nanosec == 500_000_000
