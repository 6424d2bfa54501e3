"""The types of ROS's packages, against the hashes that rosidl makes of ROS's own files."""

from pathlib import Path

import pytest

from drake_twin.messages.interface_texts import interface_names, interface_text
from drake_twin.messages.interface_types import (
    default_values,
    deserialize,
    known_names,
    knows,
    make,
    serialize,
    type_hash,
)

# Made by rosidl_adapter and rosidl_generator_type_description of ROS 2 Jazzy of the files in the branches jazzy of
# common_interfaces, rcl_interfaces, geometry2, example_interfaces, demos, rosbag2, control_msgs, ros2_control,
# topic_tools, ros_gz, navigation2, opennav_coverage, simulation_interfaces and grid_map, humble of ros_tutorials, and
# those that are released for Jazzy (ros2, main or master) of the others.
HASHES = [line.split() for line in Path(__file__).with_name("rosidl_hashes.txt").read_text().splitlines()]


@pytest.mark.parametrize("package", sorted({name.partition("/")[0] for name, _ in HASHES}))
def test_hashes_are_those_of_rosidl(package):
    wanted = {name: value for name, value in HASHES if name.startswith(f"{package}/")}
    assert {name: type_hash(name) for name in wanted} == wanted


def test_each_type_of_a_package_has_a_hash():
    known = {name for name, _ in HASHES}
    names = {name if "/action/" not in name else f"{name}_SendGoal" for name in interface_names()}
    of_no_distribution = {"drake_twin_msgs/srv/CheckTrajectory"}  # it is in docs/mirror.md
    of_1_0_7 = {f"ros_gz_interfaces/msg/LogicalCameraImage{end}" for end in ("", "Model")}
    assert names - known == of_1_0_7 | of_no_distribution


def test_constants_and_default_values():
    """gazebo_msgs/srv/GetJointProperties.srv and control_msgs/msg/MotionPrimitive.msg."""
    assert make("gazebo_msgs/srv/GetJointProperties_Response", {}).UNIVERSAL == 5
    assert default_values("control_msgs/msg/MotionPrimitive") == {"type": -1}
    assert make("nav2_msgs/action/ComputePathToPose_Result", {}).NO_VALID_PATH == 208
    assert make("bond/msg/Constants", {}).DISABLE_HEARTBEAT_TIMEOUT_PARAM == "/bond_disable_heartbeat_timeout"
    assert interface_text("std_srvs/srv/SetBool") == "bool data\n---\nbool success\nstring message\n"
    assert interface_text("std_srvs/srv/Nothing") is None


def test_a_message_with_others_of_its_package_goes_over_a_wire():
    data = {"trajectory": {"motions": [{"additional_arguments": [{"name": "speed", "value": 2.0}]}]}}
    name = "control_msgs/action/ExecuteMotionPrimitiveSequence_Goal"
    (motion,) = deserialize(name, serialize(make(name, data))).trajectory.motions
    assert motion.additional_arguments[0].value == 2.0


def test_names_of_packages():
    assert "SetLinkProperties" in known_names("gazebo_msgs", "srv")
    assert "SpawnEntity" in known_names("gazebo_msgs", "srv")
    assert known_names("turtlesim", "action") == ["RotateAbsolute"]
    assert known_names("nav_msgs", "srv") == ["GetMap", "GetPlan", "LoadMap", "SetMap"]
    assert not knows("gazebo_msgs/srv/SetLinkProperties_Foo")
    assert knows("gazebo_msgs/srv/SetModelState_Request")
    assert {"NavigateToPose", "FollowPath"} <= {*known_names("nav2_msgs", "action")}
