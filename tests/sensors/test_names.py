"""Topics, frames and rates of sensors against tables that were written by hand from Gazebo's sources.

Default topics: gz-sim's src/systems/*/*.cc; frames: gz-sensors' src/Sensor.cc and ros_gz_bridge's
src/convert/utils.cpp; folded links: libsdformat's src/parser_urdf.cc; Gazebo classic: gazebo_ros_pkgs, branch ros2. The
files have the shapes of those of real packages.
"""

import pytest
from hinge import node
from launch_files import not_started, write
from names_rig import INERTIAL, gazebo, spawned, table

from drake_twin import Twin, TwinBuilder
from drake_twin.builder.robot_file import planned_robots
from drake_twin.findings import Kind, texts
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml

IMU, CONTACTS = "sensor_msgs/msg/Imu", "ros_gz_interfaces/msg/Contacts"
IMAGE, CAMERA_INFO = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo"
BASE = f"""<robot name="r"><link name="base_footprint"/><link name="base_link">{INERTIAL}
  <collision><geometry><box size=".4 .4 .2"/></geometry></collision></link><link name="imu_link"/>
  <joint name="a" type="fixed"><parent link="base_footprint"/><child link="base_link"/></joint>
  <joint name="b" type="fixed"><parent link="base_link"/><child link="imu_link"/></joint>{{}}</robot>"""


def robot_with(tmp_path, *sensors, **options):
    file = write(tmp_path / "r.urdf", BASE.format("".join(sensors)))
    return TwinBuilder().robot("r", file, xyz=(0, 0, 0.1), **options).build()


# --- without a bridge


@pytest.mark.parametrize(
    ("sensor", "expected"),
    [
        (gazebo(), ("/r/s/imu", IMU, "r/base_footprint/s")),
        (gazebo("<topic>imu</topic>"), ("/r/imu", IMU, "r/base_footprint/s")),
        (gazebo("<topic>/imu</topic>"), ("/r/imu", IMU, "r/base_footprint/s")),
        (gazebo("<topic>__default_topic__</topic>"), ("/r/s/imu", IMU, "r/base_footprint/s")),
        (gazebo("<topic>a b@c~d</topic>"), ("/r/a_bcd", IMU, "r/base_footprint/s")),
        (gazebo("<gz_frame_id>imu_link</gz_frame_id>"), ("/r/s/imu", IMU, "r/imu_link")),
        (gazebo("<ignition_frame_id>odd</ignition_frame_id>"), ("/r/s/imu", IMU, "odd")),
        (gazebo("<gz_frame_id>a</gz_frame_id><frame_id>b</frame_id>"), ("/r/s/imu", IMU, "b")),
        (gazebo("<contact><collision>x</collision></contact>", kind="contact"), ("/r/s/contact", CONTACTS, "")),
        (
            gazebo("<contact><collision>x</collision><topic>/bump</topic></contact>", kind="contact"),
            ("/r/bump", CONTACTS, ""),
        ),
        (gazebo(kind="altimeter"), ("/r/s/altimeter", "ros_gz_interfaces/msg/Altimeter", "r/base_footprint/s")),
        (gazebo(kind="air_pressure"), ("/r/s/air_pressure", "sensor_msgs/msg/FluidPressure", "r/base_footprint/s")),
        (gazebo(kind="magnetometer"), ("/r/s/magnetometer", "sensor_msgs/msg/MagneticField", "r/base_footprint/s")),
        (gazebo(kind="navsat"), ("/r/s/navsat", "sensor_msgs/msg/NavSatFix", "r/base_footprint/s")),
        (gazebo(kind="gps"), ("/r/s/navsat", "sensor_msgs/msg/NavSatFix", "r/base_footprint/s")),
        (
            gazebo(link="a", kind="force_torque"),
            ("/r/s/forcetorque", "geometry_msgs/msg/WrenchStamped", "r/a/s"),
        ),
    ],
)
def test_without_a_bridge_a_sensor_is_below_the_robots_namespace(tmp_path, sensor, expected):
    topic, kind, frame = expected
    assert table(robot_with(tmp_path, sensor)) == {topic: (kind, frame, 0.0)}


@pytest.mark.parametrize(
    ("more", "frame"), [("", "other"), ("<optical_frame_id>imu_link</optical_frame_id>", "r/imu_link")]
)
def test_a_camera_has_its_optical_frame(tmp_path, more, frame):
    twin = robot_with(tmp_path, gazebo(f"<gz_frame_id>other</gz_frame_id><camera>{more}</camera>", kind="camera"))
    assert {found for _, found, _ in table(twin).values()} == {frame}
    assert not [text for text in twin.findings.warnings if "optical" in text]


@pytest.mark.parametrize(
    ("plugin", "expected"),
    [
        ('<plugin name="p" filename="libgazebo_ros_imu_sensor.so"/>', ("/r/p/out", "r/base_footprint")),
        (
            (
                '<plugin name="p" filename="libgazebo_ros_imu_sensor.so"><ros><remapping>~/out:=imu/data</remapping>'
                "</ros><topicName>old</topicName><frameName>old</frameName></plugin>"
            ),
            ("/r/imu/data", "r/base_footprint"),
        ),
        (
            (
                '<plugin name="p" filename="libgazebo_ros_imu_sensor.so"><ros><namespace>/demo</namespace>'
                "<argument>~/out:=data</argument></ros><frame_name>imu_link</frame_name></plugin>"
            ),
            ("/r/data", "r/imu_link"),
        ),
        (
            (
                '<plugin name="p" filename="libgazebo_ros_imu_sensor.so"><ros><remapping>~/out:=/else/imu</remapping>'
                "</ros></plugin>"
            ),
            ("/else/imu", "r/base_footprint"),
        ),
    ],
)
def test_a_plugin_of_gazebo_classic_names_its_topic_in_ros(tmp_path, plugin, expected):
    topic, frame = expected
    twin = robot_with(tmp_path, gazebo(f"<topic>ignored</topic><update_rate>20</update_rate>{plugin}"))
    assert table(twin) == {topic: (IMU, frame, 20.0)}


@pytest.mark.parametrize(
    ("plugin", "inside", "expected"),
    [
        ("laser", "", ("/world", "LaserScan", "world")),
        ("laser", "<topicName>/scan</topicName><frameName>eye</frameName>", ("/scan", "LaserScan", "eye")),
        (
            "gpu_laser",
            "<topicName>laser/scan</topicName><frameName>imu_link</frameName><robotNamespace>/r</robotNamespace>",
            ("/r/laser/scan", "LaserScan", "r/imu_link"),
        ),
        ("block_laser", "<topicName>cloud</topicName>", ("/r/cloud", "PointCloud", "world")),
        ("range", "<frameName>eye</frameName>", ("/range", "Range", "eye")),
    ],
)
def test_a_laser_of_ros_1_is_named_by_its_own_elements(tmp_path, plugin, inside, expected):
    """gazebo_ros_pkgs, branch noetic-devel: gazebo_plugins/src/gazebo_ros_{laser,gpu_laser,block_laser,range}.cpp."""
    text = f'<plugin name="p" filename="libgazebo_ros_{plugin}.so">{inside}</plugin>'
    twin = robot_with(tmp_path, gazebo(f"<ray><range><min>0.1</min><max>9</max></range></ray>{text}", kind="ray"))
    topic, kind, frame = expected
    assert table(twin) == {topic: (f"sensor_msgs/msg/{kind}", frame, 0.0)}
    assert not [item for item in twin.findings if "Name" in item.what]


def test_old_spellings_have_no_effect_and_are_findings(tmp_path):
    plugin = '<plugin name="p" filename="libgazebo_ros_imu_sensor.so"><topicName>a</topicName></plugin>'
    twin = robot_with(tmp_path, gazebo(plugin))
    assert [item.what for item in twin.findings if "topicName" in item.what] == [
        "<topicName> in <plugin> of sensor 's'"
    ]


def test_two_robots_in_namespaces_have_their_own_topics_and_frames(tmp_path):
    file = write(tmp_path / "r.urdf", BASE.format(gazebo("<topic>/imu</topic><frame_id>imu_link</frame_id>")))
    twin = TwinBuilder().robot("a", file, xyz=(0, 0, 0.1)).robot("b", file, xyz=(2, 0, 0.1), namespace="x/y").build()
    assert table(twin) == {"/a/imu": (IMU, "a/imu_link", 0.0), "/x/y/imu": (IMU, "b/imu_link", 0.0)}


def test_two_sensors_with_one_topic_are_a_warning_and_the_first_one_publishes(tmp_path):
    sensors = [gazebo("<topic>imu</topic>", name=name) for name in ("one", "two")]
    twin = robot_with(tmp_path, *sensors, gazebo("<topic>imu</topic>", name="three", kind="navsat"))
    assert table(twin) == {"/r/imu": (IMU, "r/base_footprint/one", 0.0)}
    found = [text for text in twin.findings.warnings if "publishes on /r/imu, too: the first one does" in text]
    assert [text.split("'")[1] for text in found] == ["two", "three"]


@pytest.mark.parametrize(
    ("sensor", "reason"),
    [
        (gazebo(link="b"), "such a sensor is on a link, and this is not one"),
        (gazebo(kind="force_torque"), "such a sensor is on a joint, and this is not one"),
        ('<gazebo><sensor name="s" type="imu"/></gazebo>', "it names no link"),
        (
            '<gazebo><plugin name="p" filename="libgazebo_ros_p3d.so"><body_name>tail</body_name></plugin></gazebo>',
            "the robot has no link 'tail'",
        ),
        (gazebo(kind="wideanglecamera"), "the twin has no such sensor"),
        (gazebo(kind=""), "the twin has no such sensor"),
        (gazebo(kind="gazebo_ros_p3d"), "the twin has no such sensor"),
    ],
)
def test_a_sensor_that_cannot_be_is_not_started_with_its_place(tmp_path, sensor, reason):
    twin = robot_with(tmp_path, sensor)
    (finding,) = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert finding.what.endswith(reason)
    assert finding.file.endswith("r.urdf")
    assert finding.lines


def test_a_sensor_on_a_link_that_is_not_there_is_a_finding(tmp_path):
    twin = robot_with(tmp_path, gazebo(link="tail"))
    assert any("the robot has no such link or joint" in item.what for item in twin.findings)
    assert table(twin) == {}


# --- with a bridge: turtlebot3, turtlebot4 and husarion's robots have these shapes

TURTLEBOT3 = """<sdf version="1.8"><model name="burger"><link name="base_footprint"/>
  <link name="imu_link"><sensor name="tb3_imu" type="imu"><always_on>true</always_on><update_rate>200</update_rate>
    <topic>imu</topic></sensor></link>
  <link name="base_scan"><sensor name="lds" type="gpu_lidar"><update_rate>5</update_rate><topic>scan</topic>
    <gz_frame_id>base_scan</gz_frame_id></sensor></link>
  <joint name="i" type="fixed"><parent>base_footprint</parent><child>imu_link</child></joint>
  <joint name="s" type="fixed"><parent>base_footprint</parent><child>base_scan</child></joint></model></sdf>"""
TURTLEBOT3_BRIDGE = """
- {ros_topic_name: clock, gz_topic_name: clock, ros_type_name: rosgraph_msgs/msg/Clock, gz_type_name: gz.msgs.Clock,
   direction: GZ_TO_ROS}
- {ros_topic_name: imu, gz_topic_name: imu, ros_type_name: sensor_msgs/msg/Imu, gz_type_name: gz.msgs.IMU,
   direction: GZ_TO_ROS}
- {ros_topic_name: scan, gz_topic_name: scan, ros_type_name: sensor_msgs/msg/LaserScan,
   gz_type_name: gz.msgs.LaserScan, direction: GZ_TO_ROS}
- {ros_topic_name: camera_info, gz_topic_name: camera/camera_info, ros_type_name: sensor_msgs/msg/CameraInfo,
   gz_type_name: gz.msgs.CameraInfo, direction: GZ_TO_ROS}
"""


def test_turtlebot3s_bridge_carries_its_imu_and_its_scan(tmp_path):
    file = write(tmp_path / "bridge.yaml", TURTLEBOT3_BRIDGE)
    scenario = spawned(
        tmp_path,
        TURTLEBOT3,
        "waffle",
        node("ros_gz_bridge", "parameter_bridge", parameters=[{"config_file": str(file)}]),
        node("ros_gz_image", "image_bridge", "/camera/image_raw"),
    )
    assert table(Twin(scenario)) == {
        "/imu": (IMU, "waffle/imu_link/tb3_imu", 200.0),
        "/scan": ("sensor_msgs/msg/LaserScan", "base_scan", 5.0),
    }
    found = texts(scenario.findings, Kind.WARNING)
    assert [text.split(": the bridge")[0] for text in found if "the bridge carries" in text] == [
        "/camera/camera_info to /camera_info",
        "/camera/image_raw to /camera/image_raw",
    ]
    assert "/scan to" not in " ".join(found)
    again = ScenarioFile(scenario_to_yaml(scenario), "saved").scenario
    assert table(Twin(again)) == table(Twin(scenario))


TURTLEBOT4 = BASE.format(
    gazebo("<update_rate>62</update_rate>", name="imu")
    + gazebo("<contact><collision>base_link_collision</collision></contact>", "base_link", "bumper", "contact")
)


def test_turtlebot4s_bridges_carry_default_topics(tmp_path):
    default = "/world/warehouse/model/turtlebot4/link/base_footprint/sensor/{}"
    words = [
        f"{default.format('imu/imu')}@{IMU}[ignition.msgs.IMU",
        f"{default.format('bumper/contact')}@{CONTACTS}[ignition.msgs.Contacts",
        f"{default.format('rplidar/scan')}@sensor_msgs/msg/LaserScan[ignition.msgs.LaserScan",
    ]
    remappings = [(default.format("imu/imu"), "/imu"), (default.format("bumper/contact"), "bumper_contact")]
    bridge = node("ros_ign_bridge", "parameter_bridge", *words, remappings=remappings, namespace="tb4")
    scenario = spawned(tmp_path, TURTLEBOT4, "turtlebot4", bridge)
    assert table(Twin(scenario)) == {
        "/imu": (IMU, "turtlebot4/base_footprint/imu", 62.0),
        "/tb4/bumper_contact": (CONTACTS, "", 0.0),
    }
    (text,) = [text for text in texts(scenario.findings, Kind.WARNING) if "the bridge carries" in text]
    assert "rplidar/scan" in text


HUSARION = BASE.format(
    gazebo("<update_rate>25</update_rate><topic>/imu/data_raw</topic><frame_id>imu_link</frame_id>", name="imu")
    + gazebo(
        "<update_rate>1</update_rate><topic>/gps/fix</topic><gz_frame_id>gps</gz_frame_id>",
        "base_link",
        "gps",
        "navsat",
    )
)


def test_husarions_bridge_names_a_topic_once(tmp_path):
    entries = f"- {{topic_name: /imu/data_raw, ros_type_name: {IMU}, gz_type_name: ignition.msgs.IMU, lazy: true}}\n"
    file = write(tmp_path / "bridge.yaml", entries)
    bridge = node("ros_gz_bridge", "parameter_bridge", parameters=[{"config_file": str(file)}])
    twin = Twin(spawned(tmp_path, HUSARION, "rosbot_xl", bridge))
    assert table(twin) == {"/imu/data_raw": (IMU, "imu_link", 25.0)}
    assert any("'gps'" in text and "no bridge carries /gps/fix to ROS" in text for text in twin.findings.warnings)


def test_linorobot2s_imu_and_scan_of_gazebo_classic(corpus):
    folder = corpus / "linorobot2"
    file = folder / "linorobot2_description" / "urdf" / "robots" / "2wd.urdf.xacro"
    twin = Twin(planned_robots(file, package_paths=(str(folder),), xacro_args={}).scenario)
    camera = "linorobot2_2wd/camera_depth_link"
    assert table(twin) == {
        "/linorobot2_2wd/imu/data": (IMU, "linorobot2_2wd/base_footprint", 20.0),
        "/linorobot2_2wd/scan": ("sensor_msgs/msg/LaserScan", "linorobot2_2wd/laser", 10.0),
        "/camera/color/image_raw": (IMAGE, camera, 30.0),  # remapped in the plugin's <ros>, as the next three
        "/camera/color/camera_info": (CAMERA_INFO, camera, 30.0),
        "/camera/depth/image_rect_raw": (IMAGE, camera, 30.0),
        "/camera/depth/color/points": ("sensor_msgs/msg/PointCloud2", camera, 30.0),
        "/linorobot2_2wd/camera/depth/camera_info": (CAMERA_INFO, camera, 30.0),
    }


def test_gz_topic_names_are_expanded_where_the_bridge_is_told_so(tmp_path):
    entries = f"- {{ros_topic_name: imu, gz_topic_name: imu/data_raw, ros_type_name: {IMU}, gz_type_name: g}}\n"
    file = write(tmp_path / "bridge.yaml", entries)
    for expand, expected in ((True, {}), (False, {"/ns/imu"})):
        options = {"config_file": str(file), "expand_gz_topic_names": expand}
        bridge = node("ros_gz_bridge", "parameter_bridge", parameters=[options], namespace="ns")
        assert set(table(Twin(spawned(tmp_path, HUSARION, "r", bridge)))) == set(expected)


def test_a_sensor_of_ros2_control_needs_no_bridge(tmp_path):
    bridge = node("ros_gz_bridge", "parameter_bridge", "/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock")
    states = "".join(f"<state_interface name='orientation.{axis}'/>" for axis in "xyzw")
    control = f"<ros2_control name='c' type='system'><sensor name='imu'>{states}</sensor></ros2_control></robot>"
    twin = Twin(spawned(tmp_path, HUSARION.replace("</robot>", control), "panther", bridge))
    (about,) = [text for text in twin.findings.warnings if "no bridge carries" in text]
    assert "sensor 'gps'" in about


def test_a_bridge_without_sensors_leaves_them_in_gazebo(tmp_path):
    bridge = node("ros_gz_bridge", "parameter_bridge", "/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock")
    twin = Twin(spawned(tmp_path, TURTLEBOT3, "burger", bridge))
    assert table(twin) == {}
    assert any("no bridge carries /imu to ROS" in text for text in twin.findings.warnings)
    assert set(table(Twin(spawned(tmp_path, TURTLEBOT3, "burger")))) == {"/imu", "/scan", "/scan/points"}


def test_a_line_towards_gazebo_carries_no_sensor(tmp_path):
    bridge = node("ros_gz_bridge", "parameter_bridge", f"/imu@{IMU}]gz.msgs.IMU")
    assert table(Twin(spawned(tmp_path, TURTLEBOT3, "burger", bridge))) == {}


@pytest.mark.parametrize("word", ["/imu", f"/imu@{IMU}", "@[", f"/imu@@{IMU}", "imu@[gz.msgs.IMU"])
def test_a_line_that_does_not_parse_is_a_finding(tmp_path, word):
    scenario = spawned(tmp_path, TURTLEBOT3, "burger", node("ros_gz_bridge", "parameter_bridge", word))
    (finding,) = [item for item in scenario.findings if item.kind is Kind.REFUSED_BY_ROS]
    assert f"{word!r} is not TOPIC@ROS_TYPE@GZ_TYPE" in finding.what
    assert finding.file.endswith("test.launch.py")
    assert finding.lines


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("- {gz_type_name: a}", "it names no topic"),
        ("- {topic_name: a, direction: SIDEWAYS}", "its direction is 'SIDEWAYS', where valid are"),
        ("- {topic_name: a, ros_type_name: b, gz_tpe_name: c}", "an entry of its file has no gz_type_name"),
        ("- imu", "it names no topic"),
        ("imu: 1", "is not a list of topics"),
    ],
)
def test_an_entry_of_a_bridges_file_that_cannot_be_read_is_a_finding(tmp_path, text, what):
    file = write(tmp_path / "bridge.yaml", text)
    bridge = node("ros_gz_bridge", "parameter_bridge", parameters=[{"config_file": str(file)}])
    scenario = spawned(tmp_path, TURTLEBOT3, "burger", bridge)
    (finding,) = [item for item in scenario.findings if item.kind is Kind.REFUSED_BY_ROS]
    assert what in finding.what
    assert finding.file == str(file)
    assert not_started(scenario) == ()


def test_a_key_of_a_bridges_file_that_means_nothing_is_a_finding_with_its_line(tmp_path):
    entry = "- gz_topic_name: b\n  ros_topic_nme: a\n  ros_type_name: c\n  gz_type_name: d\n"
    file = write(tmp_path / "bridge.yaml", entry)
    bridge = node("ros_gz_bridge", "parameter_bridge", parameters=[{"config_file": str(file)}])
    scenario = spawned(tmp_path, TURTLEBOT3, "burger", bridge)
    (finding,) = [item for item in scenario.findings if item.kind is Kind.IGNORED and item.file == str(file)]
    assert "ros_topic_nme of an entry of its file. Did you mean 'ros_topic_name'?" in finding.what
    assert finding.lines == (2,)
