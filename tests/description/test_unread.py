"""What a file says is used, or is a finding with its line. The files' own XML is the reference."""

import re
from random import Random

import pytest
from conftest import ARM, ROVER
from ledger import Robot, misspelt_in_silence, used_for_nothing

from drake_twin import TwinBuilder
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model
from drake_twin.description.unread import unread_in_urdf
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Kind

PACKAGES = PackageIndex((), {})

DROPS = {
    "lidar's mask": '<gazebo reference="base"><sensor name="l" type="ray"><ray><mask/></ray></sensor></gazebo>',
    "thermal camera": '<gazebo reference="base"><sensor name="cam" type="thermal_camera"/></gazebo>',
    "camera's save": '<gazebo reference="base"><sensor name="cam" type="camera"><camera><save/>'
    "</camera></sensor></gazebo>",
    "contact sensor": '<gazebo reference="base"><sensor name="bump" type="contact"/></gazebo>',
    "unknown sensor": '<gazebo reference="base"><sensor name="x" type="tricorder"/></gazebo>',
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
    "second mass": '<link name="b5"><inertial><mass value="1"/><mass value="2"/><inertia ixx="1" iyy="1" izz="1"/>'
    '</inertial></link><joint name="j5" type="fixed"><parent link="base"/><child link="b5"/></joint>',
    "element of another namespace": '<link name="b6"><x:collision xmlns:x="http://x.org"/></link><joint name="j6"'
    ' type="fixed"><parent link="base"/><child link="b6"/></joint>',
    "gazebo about nothing": '<gazebo reference="bass"><mu1>0.2</mu1></gazebo>',
    "gazebo visual": '<gazebo reference="base"><visual><transparency>0.5</transparency></visual></gazebo>',
    "kinematic": "<gazebo><kinematic>true</kinematic></gazebo>",
    "light": '<gazebo reference="base"><light name="l" type="point"/></gazebo>',
    "transmission": '<transmission name="t"><type>x</type></transmission>',
    "element of nobody": "<mine/>",
    "sensor of ROS 1": '<sensor name="s"/>',
    "gripper": '<gripper name="g"/>',
    "bound of a gpio": '<ros2_control name="g" type="system"><gpio name="io"><command_interface name="a">'
    '<param name="max">1</param></command_interface></gpio></ros2_control>',
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


def test_the_same_at_several_places_is_said_once_with_its_lines():
    text = """<robot name="r">
<link name="base"><self_collision_checking/></link>
<link name="arm"><self_collision_checking/></link>
<joint name="hinge" type="fixed"><parent link="base"/><child link="arm"/><safety_controller/></joint>
<transmission name="t"/>
<gazebo reference="arm"><kp>1</kp><dampingFactor/><plugin name="laser" filename="l.so"/></gazebo>
<gazebo><plugin filename="gz_ros2_control-system" name="c"/></gazebo>
</robot>"""
    assert [str(item) for item in unread_in_urdf(XmlReader(text))] == [
        "<self_collision_checking> in <link> (line 2, 3)",
        "<safety_controller> in <joint> (line 4)",
        "<transmission> (line 5)",
        "<dampingFactor> in <gazebo> (line 6)",
        "Gazebo plugin laser (l.so): the twin simulates no such sensor (line 6)",
    ]


def lost(tmp_path, body):
    """What becomes of a robot's file that is not used, with its lines."""
    file = tmp_path / "robot.urdf"
    file.write_text(ROBOT.format(body))
    twin = TwinBuilder().robot("r", file).build()
    found = [item for item in twin.findings if item.kind in (Kind.IGNORED, Kind.NOT_STARTED)]
    assert all(item.file == str(file) and item.robot == "r" for item in found)
    return found


HARDWARE = """<ros2_control name="h" type="{}"><joint name="hinge"><command_interface name="{}"/>
<state_interface name="{}"/></joint></ros2_control>"""


def test_names_that_simulated_hardware_does_not_have_are_findings_with_their_line(tmp_path):
    file = tmp_path / "r.urdf"
    for kind, command, state, line, what in (
        ("system", "velocity", "position", 0, ""),
        ("actuator", "position_pid", "effort", 0, ""),
        ("systm", "velocity", "position", 6, "unknown type 'systm' of <ros2_control>. Did you mean 'system'?"),
        ("system", "veloctiy", "position", 6, "<command_interface name='veloctiy'>. Did you mean 'velocity'?"),
        ("system", "velocity", "tmprtr", 7, "<state_interface name='tmprtr'>; it has position, velocity, effort"),
    ):
        file.write_text(ROBOT.format(HARDWARE.format(kind, command, state)))
        found = [item for item in load_robot_model(str(file), PACKAGES).findings if "hinge" not in item.what]
        assert [(item.lines, item.what.endswith(what)) for item in found] == ([((line,), True)] if line else [])


FLAGS = {
    "urdf": '<robot name="r"><link name="l"/><gazebo reference="l"><selfCollide>ture</selfCollide></gazebo></robot>',
    "value": '<robot name="r"><link name="l"/><gazebo reference="l"><selfCollide value="ture"/></gazebo></robot>',
    "sdf": '<sdf version="1.9"><model name="m"><static>ture</static><link name="l"/></model></sdf>',
    "degrees": '<robot name="r"><link name="l"/><gazebo reference="l"><sensor name="s" type="imu">'
    '<pose degrees="ture">0 0 0 0 0 0</pose></sensor></gazebo></robot>',
}


@pytest.mark.parametrize("form", FLAGS)
def test_a_flag_that_is_neither_true_nor_false_is_a_finding_with_its_line(tmp_path, form):
    file = tmp_path / ("r.urdf" if "robot" in FLAGS[form] else "m.sdf")
    for text, told in ((FLAGS[form], 1), (FLAGS[form].replace("ture", "true"), 0)):
        file.write_text(text)
        found = [item for item in load_robot_model(str(file), PACKAGES).findings if "'ture'" in item.what]
        assert [item.lines for item in found] == [(1,)] * told


def test_attributes_of_a_sensor_that_nothing_reads_are_findings(tmp_path):
    sensor = '<sensor name="s" type="imu" rate="5"><imu><angular_velocity><x><noise tpe="gaussian"/></x>'
    found = lost(tmp_path, f'<gazebo reference="base">{sensor}</angular_velocity></imu></sensor></gazebo>')
    assert [item.what for item in found] == [
        "the attribute rate of <sensor> of sensor 's'",
        "the attribute tpe of <noise> of sensor 's'",
    ]


def test_the_robot_without_more_loses_nothing(tmp_path):
    assert lost(tmp_path, "") == []


@pytest.mark.parametrize("drop", DROPS)
def test_what_is_dropped_is_a_finding_with_its_line(tmp_path, drop):
    found = lost(tmp_path, DROPS[drop])
    assert found
    assert all(item.lines == (6,) for item in found)


def test_a_finding_says_what_it_is_and_what_to_do(tmp_path):
    (camera,) = lost(tmp_path, DROPS["thermal camera"])
    assert camera.what == "sensor 'cam' of type thermal_camera on 'base': the twin has no such sensor"


@pytest.mark.parametrize(("inside", "unread"), [("<imu/>", []), ("<imu a='1'/>", ["imu"]), ("<lidar/>", ["lidar"])])
def test_an_empty_element_of_a_sensors_kind_asks_for_nothing(tmp_path, inside, unread):
    sensor = f'<sensor name="s" type="imu">{inside}</sensor>'
    found = lost(tmp_path, f'<gazebo reference="base">{sensor}</gazebo>')
    assert [item.what for item in found] == [f"<{tag}> in <sensor> of sensor 's'" for tag in unread]


def test_noise_that_no_channel_has_is_a_finding(tmp_path):
    sensor = '<sensor name="imu" type="imu"><noise/><imu><angular_velocity><x><noise/></x></angular_velocity></imu>'
    found = lost(tmp_path, f'<gazebo reference="base">{sensor}</sensor></gazebo>')
    assert [item.what for item in found] == ["<noise> in <sensor> of sensor 'imu'"]


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


SDF = """<sdf version="1.9"><model name="m"><static>false</static><frame name="f"><pose>0 0 1 0 0 0</pose></frame>
<link name="base"><pose>0 0 0.1 0 0 0</pose><inertial><pose>0 0 0.01 0 0 0</pose><mass>2</mass><inertia><ixx>0.02</ixx>
<ixy>0</ixy><iyy>0.02</iyy><izz>0.02</izz></inertia></inertial><visual name="v"><geometry><box><size>0.1 0.2 0.3</size>
</box></geometry><material><diffuse>0.5 0 0 1</diffuse></material></visual><collision name="c"><geometry><cylinder>
<radius>0.1</radius><length>0.2</length></cylinder></geometry><surface><friction><ode><mu>0.5</mu></ode></friction>
</surface></collision></link><link name="arm"><pose relative_to="base">0 0 0.3 0 0 0</pose><inertial><mass>1</mass>
<inertia><ixx>0.02</ixx><iyy>0.02</iyy><izz>0.02</izz></inertia></inertial><collision name="c"><geometry><sphere>
<radius>0.1</radius></sphere></geometry></collision></link><joint name="j" type="revolute"><parent>base</parent>
<child>arm</child><axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>1</upper><effort>5</effort><velocity>2</velocity>
</limit><dynamics><damping>0.1</damping></dynamics></axis></joint></model></sdf>"""


@pytest.fixture(params=[ROVER, ARM, SDF], ids=["rover", "arm", "sdf"])
def robot(request, tmp_path):
    if request.param is SDF:
        a_line_each = re.sub(r">\s*<", ">\n<", SDF)
        return Robot(a_line_each.encode(), tmp_path / "robot.sdf", PACKAGES)
    twin = TwinBuilder().robot("r", request.param).build()
    return Robot(twin.built.plans[0].description.text.encode(), tmp_path / "robot.urdf", PACKAGES)


def test_what_counts_as_used_is_used(robot):
    findings = robot.load(robot.root).findings
    assert not [item for item in findings if item.kind is Kind.IGNORED]
    assert list(used_for_nothing(robot, Random(1), 250)) == []


def test_each_name_that_means_nothing_is_a_finding_with_its_line(robot):
    assert list(misspelt_in_silence(robot, Random(1), 150)) == []


@pytest.mark.parametrize(
    ("library", "close"),
    [
        ("gz_ros_control-system", "gz_ros2_control-system"),
        ("gz-sim-dif-drive-system", "gz-sim-diff-drive-system"),
        ("libgazebo_ros_diffdrive.so", "libgazebo_ros_diff_drive.so"),
        ("libmars_rover.so", None),
    ],
)
def test_a_misspelt_library_names_the_closest(tmp_path, library, close):
    file = tmp_path / "r.urdf"
    file.write_text(f'<robot name="r"><link name="l"/><gazebo><plugin filename="{library}" name="p"/></gazebo></robot>')
    (what,) = [item.what for item in load_robot_model(str(file), PackageIndex()).findings if library in item.what]
    assert ("Did you mean" in what) is (close is not None)
    assert close is None or f"Did you mean {close!r}?" in what


def test_both_coefficients_of_an_sdf_are_used(tmp_path):
    surface = "<surface><friction><ode><mu>{}</mu><mu2>{}</mu2></ode></friction></surface>"
    box = "<geometry><box><size>0.2 0.2 0.2</size></box></geometry>"
    for mu, mu2, told in ((0.4, 0.4, []), (1, 0.2, ["mu of l: without effect"])):
        collision = f'<collision name="c">{box}{surface.format(mu, mu2)}</collision>'
        inertial = "<inertial><mass>1</mass></inertial>"
        text = f'<sdf version="1.9"><model name="m"><link name="l">{inertial}{collision}</link></model></sdf>'
        (tmp_path / "m.sdf").write_text(text)
        found = load_robot_model(str(tmp_path / "m.sdf"), PACKAGES).findings
        assert [finding.what[:23] for finding in found] == told


@pytest.mark.parametrize("tag", ["mu1", "mu2", "selfCollide", "static"])
def test_a_value_in_an_attribute_is_read_as_gazebo_reads_it(tmp_path, tag):
    reference = "" if tag == "static" else ' reference="l"'
    text = f'<robot name="r"><link name="l"/><gazebo{reference}><{tag} value="1"/></gazebo></robot>'
    assert unread_in_urdf(XmlReader(text, tmp_path / "r.urdf")) == []
