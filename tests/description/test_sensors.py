from math import pi
from pathlib import Path

import pytest
from urdf_text import parse_urdf

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import HardwareSensor, Pose, Sensor
from drake_twin.description.robot_model import load_robot_model
from drake_twin.description.sensors import sensors_in_sdf
from drake_twin.errors import InputError

BODY = """
<link name="base"/><link name="tool"/>
<joint name="flange" type="fixed"><parent link="base"/><child link="tool"/></joint>
"""


def robot(body):
    return parse_urdf(f'<robot name="r">{BODY}\n{body}\n</robot>', Path("arm.urdf"))


def imu(inside="", link="base"):
    return robot(f'<gazebo reference="{link}"><sensor name="imu" type="imu">{inside}</sensor></gazebo>').sensors


def force_torque(inside=""):
    body = f'<gazebo reference="flange"><sensor name="fts" type="force_torque">{inside}</sensor></gazebo>'
    return robot(body).sensors


def test_an_imu_is_read_with_its_place_frame_topic_and_rate():
    inside = """<pose>1 2 3 0 0 0.5</pose><update_rate>50</update_rate><topic>imu/raw</topic>
        <gz_frame_id>imu_frame</gz_frame_id><always_on>1</always_on>"""
    pose = Pose((1.0, 2.0, 3.0), (0.0, 0.0, 0.5))
    assert imu(inside) == (
        Sensor("imu", "imu", link="base", pose=pose, frame="imu_frame", topic="imu/raw", update_rate=50.0),
    )


@pytest.mark.parametrize(
    ("inside", "reference"),
    [
        ("", None),
        ("<imu/>", None),
        ("<localization>ENU</localization>", (0.0, 0.0, 0.0)),
        ("<localization>NED</localization>", (pi, 0.0, pi / 2)),
        ("<localization>NWU</localization>", (0.0, 0.0, pi / 2)),
        ("<localization>CUSTOM</localization><custom_rpy>0 0 1.5</custom_rpy>", (0.0, 0.0, 1.5)),
    ],
)
def test_an_imus_orientation_is_relative_to_the_start_or_to_the_frame_that_is_named(inside, reference):
    if "<imu/>" not in inside and inside:
        inside = f"<imu><orientation_reference_frame>{inside}</orientation_reference_frame></imu>"
    assert imu(inside)[0].orientation_reference == reference


def test_gazebo_classics_plugin_may_ask_for_an_orientation_in_the_world():
    inside = "<plugin><initial_orientation_as_reference>false</initial_orientation_as_reference></plugin>"
    assert imu(inside)[0].orientation_reference == (0.0, 0.0, 0.0)


def test_a_force_torque_sensor_measures_the_childs_wrench_on_the_parent_unless_told_otherwise():
    (sensor,) = force_torque()
    assert (sensor.joint, sensor.link, sensor.measured_on, sensor.axes) == ("flange", "", "parent", "child")
    inside = "<force_torque><frame>sensor</frame><measure_direction>parent_to_child</measure_direction></force_torque>"
    (sensor,) = force_torque(inside)
    assert (sensor.measured_on, sensor.axes) == ("child", "sensor")


def test_sensors_of_other_kinds_and_at_links_that_are_not_there_are_left_out():
    assert robot('<gazebo reference="base"><sensor name="eye" type="camera"/></gazebo>').sensors == ()
    assert imu(link="elsewhere") == ()
    assert imu(link="flange") == ()


@pytest.mark.parametrize(
    ("call", "inside", "text"),
    [
        (imu, "<update_rate>fast</update_rate>", "update_rate is 'fast', which is not a number"),
        (imu, "<update_rate>-1</update_rate>", "update_rate is '-1', but it cannot be negative"),
        (imu, "<pose>1 2 3</pose>", "pose is '1 2 3', where six numbers are needed"),
        (force_torque, "<force_torque><frame>world</frame></force_torque>", "unknown frame 'world'. Valid: child"),
    ],
)
def test_a_wrong_value_is_refused_with_its_line(call, inside, text):
    with pytest.raises(InputError, match=text) as raised:
        call(inside)
    assert raised.value.line is not None


def test_a_sensor_of_ros2_control_is_the_simulated_one_of_the_same_name():
    description = robot("""
      <gazebo reference="tool"><sensor name="imu" type="imu"/></gazebo>
      <ros2_control name="hardware" type="system"><sensor name="imu"><state_interface name="orientation.x"/>
        <state_interface name="angular_velocity.z"/><param name="frame_id">tool</param></sensor>
      <sensor name="other"/></ros2_control>""")
    found = HardwareSensor("imu", ("orientation.x", "angular_velocity.z"), {"frame_id": "tool"})
    assert description.hardware_sensors == {"imu": found, "other": HardwareSensor("other")}
    assert description.sensor("imu", "imu").link == "tool"
    assert description.sensor("other", "imu") is None


def test_sensors_of_an_sdf_model_belong_to_its_links_and_joints():
    text = """<sdf version="1.9"><model name="m"><link name="base"><sensor name="imu" type="imu">
      <pose>0 0 1 0 0 0</pose></sensor><sensor name="eye" type="camera"/></link>
      <joint name="flange" type="fixed"><sensor name="fts" type="force_torque"/></joint></model></sdf>"""
    imu_sensor, fts = sensors_in_sdf(text, Path("m.sdf"))
    assert imu_sensor == Sensor("imu", "imu", link="base", pose=Pose((0.0, 0.0, 1.0)))
    assert fts == Sensor("fts", "force_torque", joint="flange")


def test_an_sdf_robots_description_has_its_sensors(tmp_path):
    file = tmp_path / "m.sdf"
    file.write_text(
        '<sdf version="1.9"><model name="m"><link name="base"><sensor name="imu" type="imu"/></link></model></sdf>'
    )
    description = load_robot_model(str(file), PackageIndex((), {})).description
    assert [(sensor.name, sensor.link) for sensor in description.sensors] == [("imu", "base")]


def test_the_imu_of_gz_ros2_controls_cart_is_found(corpus):
    folder = corpus / "gz_ros2_control"
    file = folder / "gz_ros2_control_demos" / "urdf" / "test_cart_velocity.xacro.urdf"
    description = load_robot_model(str(file), PackageIndex((folder,), {})).description
    assert len(description.hardware_sensors["cart_imu_sensor"].state_interfaces) == 10
    sensor = description.sensor("cart_imu_sensor", "imu")
    assert (sensor.kind, sensor.topic, sensor.update_rate) == ("imu", "imu", 10.0)
    assert sensor.link in description.links
