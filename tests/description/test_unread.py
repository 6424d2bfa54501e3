"""What a file says is used, or is a finding with its line. The files' own XML is the reference."""

import copy
import random
import re

import pytest
from conftest import ARM, ROVER
from lxml import etree

from drake_twin import TwinBuilder
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model
from drake_twin.errors import InputError
from drake_twin.findings import Kind

PACKAGES = PackageIndex((), {})

# Attributes whose value may change without changing anything, and why.
WITHOUT_EFFECT = {
    ("robot", "version"): "there is one version",
    ("ros2_control", "name"): "a label",
    ("gazebo", "reference"): "what it holds may mean nothing for a link without shapes",
}

DROPS = {
    "lidar": '<gazebo reference="base"><sensor name="lds" type="gpu_lidar"><topic>scan</topic></sensor></gazebo>',
    "classic ray": '<gazebo reference="base"><sensor name="lds" type="ray"><visualize/></sensor></gazebo>',
    "camera": '<gazebo reference="base"><sensor name="cam" type="camera"/></gazebo>',
    "depth camera": '<gazebo reference="base"><sensor name="cam" type="rgbd_camera"/></gazebo>',
    "contact sensor": '<gazebo reference="base"><sensor name="bump" type="contact"/></gazebo>',
    "gps": '<gazebo reference="base"><sensor name="gps" type="navsat"/></gazebo>',
    "magnetometer": '<gazebo reference="base"><sensor name="m" type="magnetometer"/></gazebo>',
    "unknown sensor": '<gazebo reference="base"><sensor name="x" type="tricorder"/></gazebo>',
    "imu that nobody publishes": '<gazebo reference="base"><sensor name="imu" type="imu"/></gazebo>',
    "force sensor that nobody publishes": '<gazebo reference="hinge"><sensor name="ft" type="force_torque"/></gazebo>',
    "noise": '<gazebo reference="base"><sensor name="imu" type="imu"><imu><noise/></imu></sensor></gazebo>',
    "p3d": '<gazebo><plugin name="p3d" filename="libgazebo_ros_p3d.so"/></gazebo>',
    "buoyancy": '<gazebo><plugin name="gz::sim::systems::Buoyancy" filename="gz-sim-buoyancy-system"/></gazebo>',
    "imu plugin": '<gazebo><plugin name="imu" filename="libgazebo_ros_imu_sensor.so"/></gazebo>',
    "camera plugin": '<gazebo reference="base"><plugin name="c" filename="libgazebo_ros_camera.so"/></gazebo>',
    "bumper plugin": '<gazebo reference="base"><plugin name="b" filename="libgazebo_ros_bumper.so"/></gazebo>',
    "own plugin": '<gazebo><plugin name="mine" filename="libmine.so"/></gazebo>',
    "plugin without a name": "<gazebo><plugin/></gazebo>",
    "drive that lacks its joint": '<gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so"/></gazebo>',
    "gravity off": '<gazebo reference="base"><turnGravityOff>true</turnGravityOff></gazebo>',
    "gravity": '<gazebo reference="base"><gravity>false</gravity></gazebo>',
    "feedback": '<gazebo reference="hinge"><provideFeedback>true</provideFeedback></gazebo>',
    "spring": '<gazebo reference="hinge"><springStiffness>3</springStiffness></gazebo>',
    "implicit": '<gazebo reference="hinge"><implicitSpringDamper>1</implicitSpringDamper></gazebo>',
    "stop": '<gazebo reference="hinge"><stopErp>1</stopErp></gazebo>',
    "gazebo visual": '<gazebo reference="base"><visual><material/></visual></gazebo>',
    "static": "<gazebo><static>true</static></gazebo>",
    "light": '<gazebo reference="base"><light name="l" type="point"/></gazebo>',
    "transmission": '<transmission name="t"><type>x</type></transmission>',
    "element of nobody": "<mine/>",
    "sensor of ROS 1": '<sensor name="s"/>',
    "gripper": '<gripper name="g"/>',
    "gpio": '<ros2_control name="g" type="system"><gpio name="io"/></ros2_control>',
    "hardware parameter": '<ros2_control name="h" type="system"><hardware><param name="port">1</param></hardware>'
    "</ros2_control>",
    "rate of the hardware": '<ros2_control name="h" type="system" rw_rate="5"/>',
    "gain": '<ros2_control name="h" type="system"><joint name="hinge"><param name="p">1</param></joint></ros2_control>',
    "texture": '<material name="m"><texture filename="a.png"/></material>',
    "collision group": '<link name="base2"><collision_group/></link><joint name="j2" type="fixed"><parent link="base"/>'
    '<child link="base2"/></joint>',
    "link type": '<link name="b3" type="x"/><joint name="j3" type="fixed"><parent link="base"/>'
    '<child link="b3"/></joint>',
    "safety": '<link name="b4"/><joint name="j4" type="fixed"><parent link="base"/><child link="b4"/>'
    "<safety_controller/></joint>",
}
ROBOT = """<robot name="r">
<link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
<link name="tip"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
<joint name="hinge" type="revolute"><parent link="base"/><child link="tip"/><limit lower="-1" upper="1" effort="1"
 velocity="1"/></joint>
{}
</robot>"""


def lost(tmp_path, body):
    """What becomes of a robot's file that is not used, with its lines."""
    file = tmp_path / "robot.urdf"
    file.write_text(ROBOT.format(body))
    twin = TwinBuilder().robot("r", file).build()
    found = [item for item in twin.findings if item.kind in (Kind.IGNORED, Kind.NOT_STARTED)]
    assert all(item.file == str(file) and item.robot == "r" for item in found)
    return found


def test_the_robot_without_more_loses_nothing(tmp_path):
    assert lost(tmp_path, "") == []


@pytest.mark.parametrize("drop", DROPS)
def test_what_is_dropped_is_a_finding_with_its_line(tmp_path, drop):
    found = lost(tmp_path, DROPS[drop])
    assert found
    assert all(item.lines == (6,) for item in found)


def test_a_finding_says_what_it_is_and_what_to_do(tmp_path):
    (lidar,) = lost(tmp_path, DROPS["lidar"])
    assert lidar.what == "sensor 'lds' of type gpu_lidar on 'base', topic scan: the twin has no lidar"
    (imu,) = lost(tmp_path, DROPS["imu that nobody publishes"])
    assert "an imu_sensor_broadcaster in the controllers' file would" in imu.what


def test_elements_of_a_drive_that_it_does_not_read_are_findings(tmp_path):
    wheel = (
        """<link name="w{0}"/><joint name="j{0}" type="continuous"><parent link="base"/><child link="w{0}"/></joint>"""
    )
    plugin = (
        '<gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so"><left_joint>ja</left_joint>'
        "<right_joint>jb</right_joint><wheel_separation>1</wheel_separation><wheel_diameter>1</wheel_diameter>"
        "<sparkle>1</sparkle></plugin></gazebo>"
    )
    found = lost(tmp_path, wheel.format("a") + wheel.format("b") + plugin)
    assert [item.what for item in found] == ["<sparkle> of Gazebo plugin d"]


def parsed(model):
    """A robot's XML, read by nobody but the parser."""
    twin = TwinBuilder().robot("r", model).build()
    text = twin.plans[0].description.text
    return etree.fromstring(text.encode(), etree.XMLParser(remove_comments=True))


def outcome(file, root):
    """All that the twin makes of a robot's file."""
    file.write_bytes(etree.tostring(root))
    try:
        model = load_robot_model(str(file), PACKAGES)
    except InputError as error:
        return str(error)
    repairs = [repair.what for repair in model.repairs]
    return repr((model.description, model.warnings, repairs)) + re.sub(r"\s+", " ", model.drake_text)


def other(value):
    """Another value of the same kind."""
    first, *rest = value.split() or [""]
    try:
        return " ".join([repr(float(first) * 1.1 + 0.01), *rest])
    except ValueError:
        return value + "x"


@pytest.mark.parametrize("model", [ROVER, ARM])
def test_what_counts_as_used_is_used(tmp_path, model):
    root, file = parsed(model), tmp_path / "robot.urdf"
    file.write_bytes(etree.tostring(root))
    ignored = load_robot_model(str(file), PACKAGES).ignored
    before = outcome(file, root)
    tree = root.getroottree()
    items = [(tree.getpath(element), name) for element in root.iter() for name in element.attrib]
    unused = set()
    for path, name in random.Random(1).sample(items, min(len(items), 250)):
        changed = copy.deepcopy(root)
        (element,) = changed.getroottree().xpath(path)
        element.set(name, other(element.get(name)))
        if outcome(file, changed) == before:
            unused.add((element.tag, name))
    assert ignored == ()
    assert unused <= WITHOUT_EFFECT.keys()
