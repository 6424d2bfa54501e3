from types import SimpleNamespace

import numpy as np
import pytest
from pydrake.common.value import AbstractValue, Value
from pydrake.math import RigidTransform, RollPitchYaw

from drake_twin import messages
from drake_twin.description.robot_description import Joint, Pose, RobotDescription
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.messages.interface_types import serialize
from drake_twin.systems.no_message import empty_value
from drake_twin.systems.robot_state_publisher import FixedFrame, LinkFrame, RobotFrames, RobotStatePublisher

LAYOUT = StateLayout(size=4, positions={"turn": 0, "slide": 1}, velocities={"turn": 2, "slide": 3}, efforts={})
DESCRIPTION = RobotDescription(
    name="robot",
    links=("base", "arm", "hand", "camera", "buoy"),
    joints=(
        Joint("turn", "revolute", "base", "arm", Pose((1, 2, 3)), axis=(0, 0, 1)),
        Joint("slide", "prismatic", "arm", "hand", Pose((0, 0, 0), (0, 0, np.pi / 2)), axis=(1, 0, 0)),
        Joint("mount", "fixed", "base", "camera", Pose((0.1, 0, 0), (np.pi, 0, 0))),
        Joint("water", "floating", "base", "buoy"),
    ),
    text="<robot/>",
)


def evaluate(port, state=(0.0, 0.0, 0.0, 0.0), time=0.0, prefix="", description=DESCRIPTION):
    dut = RobotStatePublisher([RobotFrames("r", description, LAYOUT, prefix)], len(state))
    return at(dut, state, time, port)


def at(dut, state, time=0.0, port="tf"):
    context = dut.CreateDefaultContext()
    context.SetTime(time)
    dut.get_state_input_port().FixValue(context, list(state))
    return dut.GetOutputPort(port).Eval(context)


def xyz(transform):
    translation = transform.transform.translation
    return [translation.x, translation.y, translation.z]


def wxyz(transform):
    rotation = transform.transform.rotation
    return [rotation.w, rotation.x, rotation.y, rotation.z]


def test_a_revolute_joint_turns_its_child_about_its_axis():
    transform, _ = evaluate("tf", (np.pi / 2, 0, 0, 0)).transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("base", "arm")
    assert xyz(transform) == [1, 2, 3]
    assert wxyz(transform) == pytest.approx([np.sqrt(0.5), 0, 0, np.sqrt(0.5)])


def test_a_prismatic_joint_slides_its_child_along_its_turned_axis():
    _, transform = evaluate("tf", (0, 0.25, 0, 0)).transforms
    assert xyz(transform) == pytest.approx([0, 0.25, 0])
    assert wxyz(transform) == pytest.approx([np.sqrt(0.5), 0, 0, np.sqrt(0.5)])


def test_moving_frames_are_stamped_with_simulation_time():
    transform, _ = evaluate("tf", time=2.5).transforms
    assert (transform.header.stamp.sec, transform.header.stamp.nanosec) == (2, 500_000_000)


def test_fixed_joints_go_to_tf_static_and_floating_ones_nowhere():
    (transform,) = evaluate("tf_static").transforms
    assert transform.child_frame_id == "camera"
    assert xyz(transform) == [0.1, 0, 0]
    assert wxyz(transform) == pytest.approx([0, 1, 0, 0])


def test_the_frame_prefix_is_put_before_both_frames():
    transform, _ = evaluate("tf", prefix="robot_1/").transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("robot_1/base", "robot_1/arm")


def test_a_child_link_away_from_its_joint_frame_is_placed_as_in_sdf():
    joint = Joint("turn", "revolute", "base", "arm", axis=(0, 0, 1), child_origin=Pose((1, 0, 0)))
    description = RobotDescription("robot", ("base", "arm"), (joint,))
    (transform,) = evaluate("tf", (np.pi / 2, 0, 0, 0), description=description).transforms
    assert xyz(transform) == pytest.approx([0, 1, 0])


def test_the_robot_description_is_the_text_of_the_robot():
    assert evaluate("r/robot_description").data == "<robot/>"


# Several robots

FLOATING = StateLayout(size=13, positions={}, velocities={}, efforts={}, base_position=0, base_velocity=7)
BUOY = RobotDescription("buoy", ("buoy",), ())
UNTURNED = [2.0, 0, 0, 0, 5.0, 6.0, 7.0, *[0.0] * 6]


def children(message):
    return [transform.child_frame_id for transform in message.transforms]


def two_arms():
    layouts = [LAYOUT.within([index, 2 + index, 4 + index, 6 + index]) for index in (0, 1)]
    frames = [RobotFrames(name, DESCRIPTION, layout, f"{name}/") for name, layout in zip("ab", layouts, strict=True)]
    return RobotStatePublisher(frames, 8)


def test_the_frames_of_all_robots_meet_on_one_port_in_their_order():
    message = at(two_arms(), (np.pi, 0, 0, 0.25, 0, 0, 0, 0))
    assert children(message) == ["a/arm", "a/hand", "b/arm", "b/hand"]
    assert [wxyz(transform)[3] for transform in message.transforms[::2]] == pytest.approx([1, 0])
    assert [xyz(transform)[1] for transform in message.transforms[1::2]] == pytest.approx([0, 0.25])


def test_a_true_base_pose_is_broadcast_only_for_the_robots_asked_for_and_first():
    quiet = RobotFrames("a", DESCRIPTION, LAYOUT.within([13, 14, 15, 16]))
    dut = RobotStatePublisher([quiet, RobotFrames("b", BUOY, FLOATING, base_frame="b/buoy")], 17)
    base, *others = at(dut, [*UNTURNED, 0, 0, 0, 0], time=1.5).transforms
    assert (base.header.frame_id, base.header.stamp.nanosec, base.child_frame_id) == ("world", 500_000_000, "b/buoy")
    assert (xyz(base), wxyz(base)) == ([5, 6, 7], [1, 0, 0, 0])
    assert [transform.child_frame_id for transform in others] == ["arm", "hand"]


def test_a_welded_base_is_refused():
    with pytest.raises(ValueError, match="is a static transform"):
        RobotStatePublisher([RobotFrames("a", DESCRIPTION, LAYOUT, base_frame="base")], 4)


def test_odometry_comes_before_the_joints_and_only_when_there_is_some():
    dut = RobotStatePublisher([RobotFrames("r", DESCRIPTION, LAYOUT)], 4, odometry=["r/drive/tf_odometry"])
    context = dut.CreateDefaultContext()
    dut.get_state_input_port().FixValue(context, [0.0] * 4)
    odometry = dut.GetInputPort("r/drive/tf_odometry")
    odometry.FixValue(context, empty_value())
    assert children(dut.get_tf_output_port().Eval(context)) == ["arm", "hand"]
    place = messages.Transform(messages.Vector3(1.0, 0.0, 0.0), messages.Quaternion(0.0, 0.0, 0.0, 1.0))
    driven = messages.TransformStamped(messages.header(0.0, "odom"), "base", place)
    odometry.FixValue(context, AbstractValue.Make(messages.TFMessage([driven])))
    assert children(dut.get_tf_output_port().Eval(context)) == ["base", "arm", "hand"]


def test_static_transforms_come_first_and_with_their_pose():
    frame = FixedFrame("world", "odom", Pose((1, 2, 3), (0, 0, np.pi)))
    dut = RobotStatePublisher([RobotFrames("r", DESCRIPTION, LAYOUT)], 4, static_transforms=[frame])
    first, second = at(dut, [0.0] * 4, port="tf_static").transforms
    assert (first.header.frame_id, first.child_frame_id, second.child_frame_id) == ("world", "odom", "camera")
    assert xyz(first) == [1, 2, 3]
    assert first.transform.rotation.z == pytest.approx(1)


def test_a_message_is_not_changed_by_the_next():
    dut = RobotStatePublisher([RobotFrames("r", DESCRIPTION, LAYOUT)], 4)
    before = at(dut, (0.0, 0.0, 0, 0)).transforms[1]
    after = at(dut, (0.0, 0.5, 0, 0)).transforms[1]
    assert (xyz(before), xyz(after)) == (pytest.approx([0, 0, 0]), pytest.approx([0, 0.5, 0]))


@pytest.mark.parametrize("drives", [(), ("r/drive/tf_odometry",)])
def test_a_draft_has_what_the_port_has_without_the_drives_frames_also_after_the_context_has_changed(drives):
    dut = RobotStatePublisher([RobotFrames("r", DESCRIPTION, LAYOUT)], 4, odometry=drives)
    context, state = dut.CreateDefaultContext(), np.array([0.3, 0.2, 0.0, 0.0])
    context.SetTime(1.25)
    dut.get_state_input_port().FixValue(context, state)
    place = messages.Transform(messages.Vector3(1.0, 0.0, 0.0), messages.Quaternion(0.0, 0.0, 0.0, 1.0))
    driven = messages.TransformStamped(messages.header(1.25, "odom"), "base", place)
    for name in drives:
        dut.GetInputPort(name).FixValue(context, AbstractValue.Make(messages.TFMessage([driven])))
    on_port = dut.get_tf_output_port().Eval(context)
    assert children(on_port) == [*["base"] * len(drives), "arm", "hand"]
    expected = messages.TFMessage(on_port.transforms[len(drives) :])
    draft = dut.tf_drafter()(SimpleNamespace(time=1.25, state=state, root_context=context))
    context.SetTime(2.0)
    dut.get_state_input_port().FixValue(context, [9.0] * 4)
    assert draft.serialized() == serialize(expected) == serialize(draft.message())


def test_a_links_frame_is_its_childs_pose_in_its_parent():
    link = LinkFrame("post", "bob", parent_body=1, child_body=0)
    dut = RobotStatePublisher([RobotFrames("r", DESCRIPTION, LAYOUT)], 4, links=[link])
    context, quarter = dut.CreateDefaultContext(), RollPitchYaw(0.0, 0.0, np.pi / 2)
    dut.get_state_input_port().FixValue(context, [0.0] * 4)
    in_parent = RigidTransform(RollPitchYaw(np.pi / 2, 0.0, 0.0), [0.1, 0.2, 0.3])
    of_parent = RigidTransform(quarter, [5.0, 0.0, 0.0])
    dut.GetInputPort("body_poses").FixValue(context, Value[list[RigidTransform]]([of_parent @ in_parent, of_parent]))
    (*_, found) = dut.get_tf_output_port().Eval(context).transforms
    assert (found.header.frame_id, found.child_frame_id) == ("post", "bob")
    assert xyz(found) == pytest.approx([0.1, 0.2, 0.3])
    assert wxyz(found) == pytest.approx([np.sqrt(0.5), np.sqrt(0.5), 0, 0])
