from math import inf

import pytest

from drake_twin.description.robot_description import (
    CommandInterface,
    ControlledJoint,
    HardwareSystem,
    Joint,
    JointLimits,
    Mimic,
    RobotDescription,
)

POSITION = (CommandInterface("position", -1.0, 9.0), CommandInterface("velocity", -inf, 2.0))


def joint(name: str, kind: str = "revolute", **more) -> Joint:
    return Joint(name, kind, "base", f"{name}_link", limits=JointLimits(-3.0, 3.0, 5.0, 7.0), **more)


ROBOT = RobotDescription(
    name="arm",
    links=("base", "elbow_link", "wrist_link", "finger_link", "camera_link"),
    joints=(
        joint("elbow"),
        joint("wrist"),
        joint("finger", mimic=Mimic("wrist")),
        joint("camera", "fixed"),
    ),
    systems=(
        HardwareSystem(
            "system",
            "system",
            "plugin",
            (
                ControlledJoint("wrist", POSITION),
                ControlledJoint("elbow", POSITION),
                ControlledJoint("finger", POSITION),
                ControlledJoint("camera", POSITION),
                ControlledJoint("absent", POSITION),
            ),
        ),
    ),
)


def test_the_root_is_the_link_that_is_no_child():
    assert ROBOT.root_link == "base"


def test_movable_joints_stand_in_file_order():
    assert [joint.name for joint in ROBOT.movable_joints] == ["elbow", "wrist", "finger"]


def test_actuated_joints_stand_in_the_order_of_ros2_control_without_followers_and_fixed_joints():
    assert [joint.name for joint in ROBOT.actuated_joints] == ["wrist", "elbow"]


def test_controlled_joints_that_the_robot_lacks_or_that_do_not_move_are_left_out():
    assert list(ROBOT.controlled_joints) == ["wrist", "elbow", "finger"]


@pytest.mark.parametrize(
    ("interface", "limits"), [("position", (-1.0, 3.0)), ("velocity", (-5.0, 2.0)), ("effort", (-7.0, 7.0))]
)
def test_a_command_is_bounded_by_the_tighter_of_urdf_and_ros2_control(interface, limits):
    assert ROBOT.limits_of_command("elbow", interface) == limits
