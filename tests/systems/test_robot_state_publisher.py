import numpy as np
import pytest

from drake_twin.description.robot_description import Joint, Pose, RobotDescription
from drake_twin.systems.robot_state_publisher import RobotStatePublisher
from drake_twin.systems.state_layout import StateLayout

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
    dut = RobotStatePublisher(description, LAYOUT, prefix)
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
    assert evaluate("robot_description").data == "<robot/>"
