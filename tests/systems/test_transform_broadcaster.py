import numpy as np
import pytest
from pydrake.common.value import AbstractValue

from drake_twin import messages
from drake_twin.description.robot_description import Pose
from drake_twin.systems.frames import transform_messages
from drake_twin.systems.transform_broadcaster import FixedFrame, TransformBroadcaster


def frames(parent, *children):
    count = len(children)
    transforms = transform_messages([parent] * count, children, np.zeros((count, 3)), np.eye(4)[[0] * count], 0.0)
    return messages.TFMessage(transforms=transforms)


def odometry(frame, x):
    zero = messages.Vector3(x=0.0, y=0.0, z=0.0)
    pose = messages.Pose(
        position=messages.Point(x=x, y=0.0, z=0.0), orientation=messages.Quaternion(x=0.0, y=0.0, z=0.0, w=1.0)
    )
    return messages.Odometry(
        header=messages.header(1.0, "world"),
        child_frame_id=frame,
        pose=messages.PoseWithCovariance(pose=pose, covariance=np.zeros(36)),
        twist=messages.TwistWithCovariance(twist=messages.Twist(linear=zero, angular=zero), covariance=np.zeros(36)),
    )


def evaluate(dut, port, **inputs):
    context = dut.CreateDefaultContext()
    for index in range(dut.num_input_ports()):
        input_port = dut.get_input_port(index)
        value = inputs.get(input_port.get_name().replace("/", "_"), messages.TFMessage(transforms=[]))
        input_port.FixValue(context, AbstractValue.Make(value))
    return [transform.child_frame_id for transform in dut.GetOutputPort(port).Eval(context).transforms]


def test_the_frames_of_all_robots_meet_on_one_port_in_their_order():
    dut = TransformBroadcaster(["a", "b"])
    assert evaluate(dut, "tf", b_tf=frames("b", "b1"), a_tf=frames("a", "a1", "a2")) == ["a1", "a2", "b1"]


def test_a_true_base_pose_is_broadcast_only_for_the_robots_asked_for():
    dut = TransformBroadcaster(["a", "b"], moving_bases=["b"])
    assert not dut.HasInputPort("a/ground_truth/odom")
    assert evaluate(dut, "tf", b_ground_truth_odom=odometry("b/base", 2.0)) == ["b/base"]


def test_the_base_transform_is_the_pose_of_the_odometry():
    dut = TransformBroadcaster(["b"], moving_bases=["b"])
    context = dut.CreateDefaultContext()
    dut.GetInputPort("b/tf").FixValue(context, AbstractValue.Make(frames("b")))
    dut.GetInputPort("b/ground_truth/odom").FixValue(context, AbstractValue.Make(odometry("b/base", 2.0)))
    (transform,) = dut.get_tf_output_port().Eval(context).transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("world", "b/base")
    assert transform.transform.translation.x == 2.0


def test_static_transforms_come_first_and_with_their_pose():
    dut = TransformBroadcaster(["a"], static_transforms=[FixedFrame("world", "odom", Pose((1, 2, 3), (0, 0, np.pi)))])
    context = dut.CreateDefaultContext()
    dut.GetInputPort("a/tf_static").FixValue(context, AbstractValue.Make(frames("a", "camera")))
    first, second = dut.get_tf_static_output_port().Eval(context).transforms
    assert (first.header.frame_id, first.child_frame_id, second.child_frame_id) == ("world", "odom", "camera")
    assert first.transform.translation.y == 2
    assert first.transform.rotation.z == pytest.approx(1)
