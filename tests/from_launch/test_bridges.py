"""The topics that the bridges of a launch file carry."""

import json

import pytest

from drake_twin.findings import Kind, Place
from drake_twin.from_launch.bridges import BridgeLine, bridge_lines, is_bridge, renamed, stamped
from drake_twin.ros2.launched import LaunchedProcess

IMU = "sensor_msgs/msg/Imu"


def bridge(*words, executable="parameter_bridge", package="ros_gz_bridge", **more):
    return LaunchedProcess("node", executable, Place("a.launch.py", 4), package, arguments=words, **more)


def read(process):
    findings = []
    return bridge_lines(process, findings), [(item.kind, item.what) for item in findings]


@pytest.mark.parametrize(
    ("package", "executable", "expected"),
    [
        ("ros_gz_bridge", "parameter_bridge", True),
        ("ros_gz_bridge", "bridge_node", True),
        ("ros_ign_bridge", "parameter_bridge", True),
        ("ros_gz_image", "image_bridge", True),
        ("ros_gz_bridge", "static_bridge", False),
        ("my_bridges", "parameter_bridge", False),
        (None, "parameter_bridge", False),
    ],
)
def test_which_nodes_are_bridges(package, executable, expected):
    assert is_bridge(bridge(executable=executable, package=package)) is expected


@pytest.mark.parametrize(
    ("mark", "direction", "to_ros"),
    [("@", "BIDIRECTIONAL", True), ("[", "GZ_TO_ROS", True), ("]", "ROS_TO_GZ", False)],
)
def test_a_word_names_topic_type_and_direction(mark, direction, to_ros):
    lines, findings = read(bridge(f"/imu@{IMU}{mark}gz.msgs.IMU", remappings=(("/imu", "/robot/imu"),)))
    assert (lines, findings) == ((BridgeLine("/imu", "/robot/imu", IMU, direction),), [])
    assert (lines[0].is_to_ros, lines[0].place.line, renamed(lines)) == (to_ros, 4, {"/imu": "/robot/imu"})


@pytest.mark.parametrize("word", ["/imu", "@sensor_msgs/msg/Imu@gz.msgs.IMU", "/imu@sensor_msgs/msg/Imu", "/imu@[gz.a"])
def test_a_word_of_another_form_is_refused_as_by_ros(word):
    lines, ((kind, what),) = read(bridge(word))
    assert (lines, kind) == ((), Kind.REFUSED_BY_ROS)
    assert "is not TOPIC@ROS_TYPE@GZ_TYPE" in what


def test_services_are_no_topics():
    assert read(bridge("/world/w/control@ros_gz_interfaces/srv/ControlWorld")) == ((), [])


def test_an_image_bridge_takes_names_alone():
    lines, _ = read(bridge("/eye/image", "--verbose", executable="image_bridge", package="ros_gz_image"))
    assert lines == (BridgeLine("/eye/image", "/eye/image", "sensor_msgs/msg/Image", "GZ_TO_ROS"),)


def test_a_file_names_topics_types_and_directions(tmp_path):
    entries = [
        {"topic_name": "/imu", "ros_type_name": IMU, "gz_type_name": "gz.msgs.IMU", "direction": "GZ_TO_ROS"},
        {
            "ros_topic_name": "cmd_vel",
            "gz_topic_name": "/model/r/cmd_vel",
            "ros_type_name": "geometry_msgs/msg/TwistStamped",
            "gz_type_name": "gz.msgs.Twist",
        },
        {"ros_topic_name": "x", "direction": "BOTH", "ros_type_name": IMU, "gz_type_name": "gz.msgs.IMU"},
        {"ros_type_name": IMU},
        {"topic_name": "/y", "gz_type_name": "gz.msgs.IMU", "queue": 3},
    ]
    (tmp_path / "b.yaml").write_text(json.dumps(entries))
    lines, findings = read(bridge(parameters=({"config_file": str(tmp_path / "b.yaml")},), namespace="/r"))
    assert lines == (
        BridgeLine("/imu", "/imu", IMU, "GZ_TO_ROS"),
        BridgeLine("/model/r/cmd_vel", "/r/cmd_vel", "geometry_msgs/msg/TwistStamped"),
        BridgeLine("/y", "/y"),
    )
    assert stamped(lines) == ("/model/r/cmd_vel",)
    for (kind, what), (expected, part) in zip(
        findings,
        [
            (Kind.REFUSED_BY_ROS, "its direction is 'BOTH', where valid are"),
            (Kind.REFUSED_BY_ROS, "it names no topic"),
            (Kind.IGNORED, "queue of an entry of its file"),
            (Kind.REFUSED_BY_ROS, "has no ros_type_name"),
        ],
        strict=True,
    ):
        assert (kind, part in what) == (expected, True)
