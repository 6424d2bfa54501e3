from math import nan, pi
from pathlib import Path

import pytest
from urdf_text import parse_urdf

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import HardwareSensor, Pose, Sensor
from drake_twin.description.robot_model import load_robot_model
from drake_twin.description.sensors import sensors_in_sdf
from drake_twin.description.xml_reader import XmlReader
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
    expected = Sensor("imu", "imu", "base", "", "base", pose, frame="imu_frame", topic="imu/raw", update_rate=50.0)
    assert imu(inside) == (expected,)


def test_sensors_at_links_that_are_not_there_are_left_out_and_all_others_are_found():
    (eye,) = robot('<gazebo reference="base"><sensor name="eye" type="camera"/></gazebo>').sensors
    assert (eye.kind, eye.link) == ("camera", "base")
    assert imu(link="elsewhere") == ()
    assert [(sensor.link, sensor.joint) for sensor in imu(link="flange")] == [("", "flange")]


CHAIN = """<link name="base"/><link name="mast"/><link name="head"/><link name="arm"/>
<joint name="a" type="fixed"><parent link="base"/><child link="mast"/></joint>
<joint name="b" type="fixed"><parent link="mast"/><child link="head"/></joint>
<joint name="c" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
  <limit effort="1" velocity="1" lower="-1" upper="1"/></joint>"""


@pytest.mark.parametrize(
    ("link", "more", "expected"),
    [
        ("base", "", "base"),
        ("mast", "", "base"),
        ("head", "", "base"),
        ("arm", "", "arm"),
        ("head", '<gazebo reference="b"><preserveFixedJoint>true</preserveFixedJoint></gazebo>', "head"),
        ("head", '<gazebo reference="a"><disableFixedJointLumping>1</disableFixedJointLumping></gazebo>', "mast"),
        ("head", '<gazebo reference="b"><preserveFixedJoint>false</preserveFixedJoint></gazebo>', "base"),
    ],
)
def test_gazebo_folds_links_on_fixed_joints_into_their_parents(link, more, expected):
    text = f'<gazebo reference="{link}"><sensor name="s" type="imu"/></gazebo>'
    (sensor,) = parse_urdf(f'<robot name="r">{CHAIN}{more}{text}</robot>', Path("arm.urdf")).sensors
    assert (sensor.link, sensor.gazebo_link) == (link, expected)


def test_a_robot_that_is_fixed_to_the_world_keeps_its_first_link():
    text = """<robot name="r"><link name="world"/><link name="base"/>
      <joint name="a" type="fixed"><parent link="world"/><child link="base"/></joint>
      <gazebo reference="base"><sensor name="s" type="imu"/></gazebo></robot>"""
    (sensor,) = parse_urdf(text, Path("arm.urdf")).sensors
    assert sensor.gazebo_link == "base"


def test_a_plugin_of_gazebo_classic_may_be_a_sensor_by_itself():
    (sensor,) = robot("""<gazebo><plugin name="truth" filename="libgazebo_ros_p3d.so"><body_name>tool</body_name>
      <update_rate>20</update_rate><frame_name>base</frame_name></plugin></gazebo>""").sensors
    found = (sensor.name, sensor.kind, sensor.link, sensor.gazebo_link, sensor.update_rate, sensor.frame)
    assert found == ("truth", "gazebo_ros_p3d", "tool", "base", 20.0, "base")


def test_a_plugin_on_a_joint_is_at_the_joints_child():
    (sensor,) = robot("""<gazebo><plugin name="ft" filename="libgazebo_ros_ft_sensor.so"><joint_name>flange</joint_name>
      </plugin></gazebo>""").sensors
    assert (sensor.kind, sensor.joint, sensor.link, sensor.gazebo_link) == (
        "gazebo_ros_ft_sensor",
        "flange",
        "",
        "tool",
    )


def test_a_pose_in_an_sdf_may_be_in_degrees_and_relative_to_a_frame():
    text = """<sdf version="1.9"><model name="m"><link name="base"><sensor name="imu" type="imu">
      <pose degrees="true" relative_to="mast">0 0 1 0 0 90</pose></sensor></link></model></sdf>"""
    (sensor,) = sensors_in_sdf(XmlReader(text, Path("m.sdf")))
    assert sensor.pose.rpy == pytest.approx((0, 0, pi / 2))
    assert sensor.pose_frame == "mast"


@pytest.mark.parametrize(
    ("call", "inside", "text"),
    [
        (imu, "<update_rate>fast</update_rate>", "update_rate is 'fast', which is not a number"),
        (imu, "<update_rate>-1</update_rate>", "update_rate is '-1', but it cannot be negative"),
        (imu, "<pose>1 2 3</pose>", "pose is '1 2 3', where six numbers are needed"),
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
    found = HardwareSensor("imu", {"orientation.x": nan, "angular_velocity.z": nan}, {"frame_id": "tool"})
    assert description.hardware_sensors == {"imu": found, "other": HardwareSensor("other")}
    assert description.sensor("imu", "imu").link == "tool"
    assert description.sensor("other", "imu") is None


def test_sensors_of_an_sdf_model_belong_to_its_links_and_joints():
    text = """<sdf version="1.9"><model name="m"><link name="base"><sensor name="imu" type="imu">
      <pose>0 0 1 0 0 0</pose></sensor><sensor name="eye" type="camera"/></link>
      <joint name="flange" type="fixed"><sensor name="fts" type="force_torque"/></joint></model></sdf>"""
    imu_sensor, eye, fts = sensors_in_sdf(XmlReader(text, Path("m.sdf")))
    assert imu_sensor == Sensor("imu", "imu", link="base", gazebo_link="base", pose=Pose((0.0, 0.0, 1.0)))
    assert eye == Sensor("eye", "camera", link="base", gazebo_link="base")
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
