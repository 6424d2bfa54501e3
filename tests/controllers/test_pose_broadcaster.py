"""The assertions of ros2_controllers' test_pose_broadcaster.cpp, cited by line, and the twin's own."""

from dataclasses import replace
from math import cos, isnan, nan, sin

import numpy as np
import pytest
from controller_parameters import parameters_of
from device_harness import ROBOT, Running, setup_of

from drake_twin import TwinBuilder, messages
from drake_twin.controllers.pose_broadcaster import PoseBroadcaster
from drake_twin.description.robot_description import HardwareSensor, HardwareSystem
from drake_twin.errors import InputError

KIND = "pose_broadcaster/PoseBroadcaster"
VALUES = [1.1, 2.2, 3.3, 0.39190382, 0.20056212, 0.53197575, 0.72331744]
GIVEN = {"frame_id": "pose_base_frame", "pose_name": "test_pose", "tf": {"child_frame_id": "pose_frame"}}


def broadcaster(values=VALUES, description=ROBOT, frame_prefix="", **given):
    parameters = parameters_of(KIND, **{**GIVEN, **given})
    setup = replace(setup_of(PoseBroadcaster, parameters, frame_prefix=frame_prefix), description=description)
    return Running(PoseBroadcaster(setup), values=list(values))


def pose_of(message):
    place, turned = message.pose.position, message.pose.orientation
    return [place.x, place.y, place.z, turned.x, turned.y, turned.z, turned.w]


def transform_of(message):
    place, turned = message.transform.translation, message.transform.rotation
    return [place.x, place.y, place.z, turned.x, turned.y, turned.z, turned.w]


def test_it_reads_seven_state_interfaces_and_claims_none():
    parameters = parameters_of(KIND, **GIVEN)
    assert PoseBroadcaster.claimed_interfaces(parameters, ROBOT) == ()  # :88, :114, :130
    names = PoseBroadcaster.state_interfaces(parameters)
    assert len(names) == 7  # :94, :119, :135
    assert names[0] == "test_pose/position.x"
    assert names[6] == "test_pose/orientation.w"


def test_it_is_activated_and_deactivated():
    run = broadcaster()
    assert run.output("pose") is not None  # :107, :151
    run.controller.deactivate(run.context)  # :123
    assert run.output("pose") is None
    assert run.output("tf_odometry") is None


def test_the_pose_is_published_as_a_message_and_as_a_transform():
    run = broadcaster()
    run.advance(0.25)
    message = run.output("pose")
    assert message.header.frame_id == "pose_base_frame"  # :177
    assert pose_of(message) == VALUES  # :178 to :184
    (transform,) = run.output("tf_odometry").transforms  # :191
    assert transform.header.frame_id == "pose_base_frame"  # :192
    assert transform.child_frame_id == "pose_frame"  # :193
    assert transform_of(transform) == VALUES  # :194 to :200
    assert message.header.stamp.nanosec == transform.header.stamp.nanosec == 250_000_000
    assert messages.type_store().serialize_cdr(message, message.__msgtype__)


def test_an_invalid_pose_is_no_transform():
    run = broadcaster([nan, *VALUES[1:]])
    message = run.output("pose")
    assert message.header.frame_id == "pose_base_frame"  # :226
    assert isnan(message.pose.position.x)  # :227
    assert pose_of(message)[1:] == VALUES[1:]  # :228 to :233
    assert run.output("tf_odometry") is None  # :237, :239
    run.fix("values", [0.0, 2.2, 3.3, 0.0, 0.0, 0.0, 0.0])
    assert run.output("tf_odometry") is None  # :248, :250
    run.fix("values", [0.0, 2.2, 3.3, 0.0, 0.0, 0.0, 1.0049])  # its square is 1.0098: within upstream's 10e-3
    assert run.output("tf_odometry") is not None
    run.fix("values", [0.0, 2.2, 3.3, 0.0, 0.0, 0.0, 1.0051])
    assert run.output("tf_odometry") is None


@pytest.mark.parametrize("name", ["frame_id", "pose_name"])
def test_an_empty_name_is_refused(name):
    with pytest.raises(InputError, match=f"{name} is empty"):
        parameters_of(KIND, **{**GIVEN, name: ""})


def test_the_child_frame_is_the_poses_name_unless_given():
    (transform,) = broadcaster(tf={}).output("tf_odometry").transforms
    assert transform.child_frame_id == "test_pose"


def test_links_get_the_robots_prefix():
    run = broadcaster(frame_id="finger_link", tf={"child_frame_id": "palm"}, frame_prefix="robot_1/")
    assert run.output("pose").header.frame_id == "robot_1/finger_link"
    (transform,) = run.output("tf_odometry").transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("robot_1/finger_link", "robot_1/palm")
    assert run.controller.odometry_frames == ("robot_1/finger_link", "robot_1/palm")


def test_without_tf_there_is_no_transform():
    run = broadcaster(tf={"enable": False})
    assert not run.controller.HasOutputPort("tf_odometry")
    assert run.controller.odometry_frames is None


def test_a_link_with_a_parent_gets_no_second_one_and_it_is_said():
    run = broadcaster(tf={"child_frame_id": "finger_link"})
    assert not run.controller.HasOutputPort("tf_odometry")
    assert any("'finger_link' has its parent in the robot's file" in text for text in run.controller.warnings)


def test_a_pose_of_no_link_is_said():
    assert any("name no link: the pose is not simulated" in text for text in broadcaster().controller.warnings)
    sensor = HardwareSensor("test_pose", parameters={"frame_id": "thumb_link"})
    known = replace(ROBOT, systems=(HardwareSystem("s", "sensor", "", sensors=(sensor,)),))
    assert broadcaster(description=known).controller.warnings == ()


SWING = """<robot name="swing">
  <link name="world"/>
  <link name="base"><inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="arm"><inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="tip"/>
  <joint name="stand" type="fixed"><parent link="world"/><child link="base"/><origin xyz="1 2 3" rpy="0 0 1.5"/></joint>
  <joint name="axle" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint>
  <joint name="end" type="fixed"><parent link="arm"/><child link="tip"/><origin xyz="2 0 0"/></joint>
  <ros2_control name="s" type="system">
    <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
    <joint name="axle"><command_interface name="velocity"/>
      <state_interface name="position"><param name="initial_value">0.4</param></state_interface></joint>
    <sensor name="tip_pose"><param name="frame_id">tip</param>INTERFACES</sensor>
    <sensor name="other">INTERFACES</sensor>
  </ros2_control>
</robot>"""
INTERFACES = "".join(
    f'<state_interface name="{name}"/>'
    for name in (*(f"position.{axis}" for axis in "xyz"), *(f"orientation.{axis}" for axis in "xyzw"))
)


def swing(tmp_path, pose_name, frame_id, text=SWING):
    file = tmp_path / "swing.urdf"
    file.write_text(text.replace("INTERFACES", INTERFACES))
    given = {"pose_name": pose_name, "frame_id": frame_id}
    return TwinBuilder().robot("swing", file).controller("swing", "pose", KIND, given).build()


@pytest.mark.parametrize(
    ("frame_id", "expected"),
    [
        ("base", [2 * cos(0.4), 2 * sin(0.4), 0, 0, 0, sin(0.2), cos(0.2)]),
        ("map", [1 + 2 * cos(1.9), 2 + 2 * sin(1.9), 3, 0, 0, sin(0.95), cos(0.95)]),
    ],
)
def test_in_a_twin_the_pose_is_the_links_true_one(frame_id, expected, tmp_path):
    twin = swing(tmp_path, "tip_pose", frame_id)
    twin.advance_to(0.02)
    np.testing.assert_allclose(pose_of(twin.latest("/swing/pose/pose")), expected, atol=1e-6)
    (transform,) = [item for item in twin.latest("/tf").transforms if item.child_frame_id == "swing/tip_pose"]
    np.testing.assert_allclose(transform_of(transform), expected, atol=1e-6)
    assert transform.header.frame_id == {"base": "swing/base", "map": "map"}[frame_id]


def test_in_a_twin_a_pose_of_no_link_is_not_invented(tmp_path):
    twin = swing(tmp_path, "other", "base")
    twin.advance_to(0.02)
    assert all(map(isnan, pose_of(twin.latest("/swing/pose/pose"))))
    assert any("the pose is not simulated" in text for text in twin.findings.warnings)
    assert [item for item in twin.latest("/tf").transforms if item.child_frame_id == "swing/other"] == []


def test_initial_values_of_the_file_stand_for_a_pose_of_no_link(tmp_path):
    text = SWING.replace(
        '<sensor name="other">INTERFACES',
        '<sensor name="other">'
        + "".join(
            f'<state_interface name="{name}"><param name="initial_value">{value}</param></state_interface>'
            for name, value in zip(PoseBroadcaster.state_interfaces(parameters_of(KIND, **GIVEN)), VALUES, strict=True)
        ).replace("test_pose/", ""),
    )
    twin = swing(tmp_path, "other", "base", text)
    twin.advance_to(0.02)
    assert pose_of(twin.latest("/swing/pose/pose")) == VALUES


def test_a_sensor_that_ros2_control_lacks_is_said(tmp_path):
    text = SWING.replace('<state_interface name="x"/>', "")
    twin = swing(tmp_path, "nothing", "base", text)
    assert any("no state interface nothing/position.x" in str(item) for item in twin.findings), twin.findings
