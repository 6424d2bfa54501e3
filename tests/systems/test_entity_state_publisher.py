import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.math import SpatialVelocity

from drake_twin import messages
from drake_twin.systems.entity_state_publisher import EntityStatePublisher

WORLD, BASE, WHEEL, BOX = range(4)  # bodies, the world first, as a plant counts them


@pytest.fixture
def dut():
    return EntityStatePublisher(
        {"box": BOX, "rover": BASE}, {"rover::base": BASE, "rover::wheel": WHEEL, "box::b": BOX}
    )


def fix(dut, context, poses, velocities):
    dut.get_body_poses_input_port().FixValue(context, Value[list[RigidTransform]](poses))
    dut.get_body_spatial_velocities_input_port().FixValue(context, Value[list[SpatialVelocity]](velocities))


@pytest.fixture
def context(dut):
    context = dut.CreateDefaultContext()
    poses = [
        RigidTransform(),
        RigidTransform(RotationMatrix.MakeZRotation(np.pi / 2), [1, 2, 3]),
        RigidTransform(RotationMatrix.MakeXRotation(np.pi / 3), [4, 5, 6]),
        RigidTransform([7, 8, 9]),
    ]
    velocities = [SpatialVelocity(w=[body, 0.5, -body], v=[10 * body, 20, 30 * body]) for body in range(4)]
    fix(dut, context, poses, velocities)
    return context


def numbers(vector):
    return [vector.x, vector.y, vector.z]


def test_each_model_has_the_state_of_its_root_link_in_the_order_of_the_models(dut, context):
    message = dut.get_model_states_output_port().Eval(context)
    assert message.name == ["box", "rover"]
    assert [numbers(pose.position) for pose in message.pose] == [[7, 8, 9], [1, 2, 3]]
    box, rover = (pose.orientation for pose in message.pose)
    assert [box.w, *numbers(box)] == [1, 0, 0, 0]
    assert [rover.w, *numbers(rover)] == pytest.approx([np.sqrt(0.5), 0, 0, np.sqrt(0.5)])


def test_each_link_has_its_own_state(dut, context):
    message = dut.get_link_states_output_port().Eval(context)
    assert message.name == ["rover::base", "rover::wheel", "box::b"]
    wheel = message.pose[1]
    assert numbers(wheel.position) == [4, 5, 6]
    assert [wheel.orientation.w, *numbers(wheel.orientation)] == pytest.approx([np.cos(np.pi / 6), 0.5, 0, 0])


def test_twists_are_in_the_worlds_axes_however_the_link_is_turned(dut, context):
    rover = dut.get_model_states_output_port().Eval(context).twist[1]
    assert (numbers(rover.linear), numbers(rover.angular)) == ([10, 20, 30], [1, 0.5, -1])
    wheel = dut.get_link_states_output_port().Eval(context).twist[1]
    assert (numbers(wheel.linear), numbers(wheel.angular)) == ([20, 20, 60], [2, 0.5, -2])


def test_a_new_state_is_a_new_message(dut, context):
    dut.get_model_states_output_port().Eval(context)
    fix(dut, context, [RigidTransform([0, 0, body]) for body in range(4)], [SpatialVelocity.Zero()] * 4)
    message = dut.get_model_states_output_port().Eval(context)
    assert [pose.position.z for pose in message.pose] == [BOX, BASE]
    assert numbers(message.twist[0].linear) == [0, 0, 0]


def test_the_messages_go_to_a_wire(dut, context):
    store = messages.type_store()
    for port, kind in (
        (dut.get_model_states_output_port(), "gazebo_msgs/msg/ModelStates"),
        (dut.get_link_states_output_port(), "gazebo_msgs/msg/LinkStates"),
    ):
        message = port.Eval(context)
        assert store.deserialize_cdr(store.serialize_cdr(message, kind), kind).name == message.name


def test_a_world_without_models_publishes_empty_lists():
    dut = EntityStatePublisher({}, {})
    context = dut.CreateDefaultContext()
    fix(dut, context, [RigidTransform()], [SpatialVelocity.Zero()])
    message = dut.get_link_states_output_port().Eval(context)
    assert (message.name, message.pose, message.twist) == ([], [], [])
