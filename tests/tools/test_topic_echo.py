"""What ``topic echo`` prints, as rosidl_runtime_py and ``ros2 topic echo`` of Jazzy print it."""

import pytest
from tools.two_rovers import STATES, tool_of_two_rovers

from drake_twin.messages.interface_types import make
from drake_twin.program import ArgumentParser
from drake_twin.tools import topic
from drake_twin.tools.topic_echo import _field, _field_text, _text, add_echo

STATE = {"header": {"stamp": {"sec": 1, "nanosec": 5}, "frame_id": "map"}, "name": ["a", "bc"], "position": [1.0, -2.5]}


def printed(kind, fields, *words):
    parser = ArgumentParser()
    add_echo(parser)
    return _text(make(kind, fields), parser.parse_args(["/topic", *words]))


def test_arrays_and_texts_are_named_instead_of_printed():
    assert printed("sensor_msgs/msg/JointState", STATE, "--no-arr", "--no-str") == (
        "header:\n  stamp:\n    sec: 1\n    nanosec: 5\n  frame_id: '<string length: <3>>'\n"
        "name: '<sequence type: string, length: 2>'\nposition: '<sequence type: double, length: 2>'\n"
        "velocity: '<sequence type: double, length: 0>'\neffort: '<sequence type: double, length: 0>'\n---"
    )
    covariance = printed("geometry_msgs/msg/PoseWithCovariance", {}, "--no-arr").splitlines()[-2]
    assert covariance == "covariance: '<array type: double[36]>'"
    assert printed("std_msgs/msg/ByteMultiArray", {}, "--no-arr").endswith(
        "data: '<sequence type: octet, length: 0>'\n---"
    )
    assert "name:\n- '<string length: <1>>'\n- '<string length: <2>>'\n" in printed(
        "sensor_msgs/msg/JointState", STATE, "--no-str"
    )


def test_values_with_commas():
    assert printed("sensor_msgs/msg/JointState", STATE, "--csv") == "1,5,map,a,bc,1.0,-2.5,,"
    assert printed("std_msgs/msg/Float64MultiArray", {"data": [1.0, 2.0, 3.0]}, "--csv", "-l", "2") == "0,1.0,2.0,..."


@pytest.mark.parametrize(
    ("kind", "fields", "field", "text"),
    [
        ("std_msgs/msg/String", {"data": "a" * 200}, "data", "a" * 200),
        ("sensor_msgs/msg/JointState", STATE, "header.frame_id", "map"),
        ("sensor_msgs/msg/JointState", STATE, "position", "array('d', [1.0, -2.5])"),
        ("sensor_msgs/msg/JointState", STATE, "name", "['a', 'bc']"),
        ("sensor_msgs/msg/Image", {"data": [1, 255]}, "data", "array('B', [1, 255])"),
        ("std_msgs/msg/Int64MultiArray", {"data": [-1, 2]}, "data", "array('q', [-1, 2])"),
        ("sensor_msgs/msg/Imu", {}, "angular_velocity_covariance", "[0. 0. 0. 0. 0. 0. 0. 0. 0.]"),
        (
            *("geometry_msgs/msg/Polygon", {"points": [{"x": 1.0}]}, "points"),
            "[geometry_msgs.msg.Point32(x=1.0, y=0.0, z=0.0)]",
        ),
        ("std_msgs/msg/Bool", {"data": True}, "data", "True"),
    ],
)
def test_fields_are_printed_as_python_has_them_in_rclpy(kind, fields, field, text):
    """Sequences of numbers are Python's arrays there, fixed ones NumPy's; nothing is cut."""
    assert _field_text(*_field(make(kind, fields), field)) == text


@pytest.fixture
def tool(capsys, monkeypatch):
    with tool_of_two_rovers(capsys, monkeypatch) as tool:
        yield tool


def test_messages_are_chosen_by_an_expression(tool):
    tool.twin.advance_to(0.5)
    code, out, _ = tool(topic, "echo", "/clock", "--once", "--filter", "m.clock.nanosec % 50000000 == 0")
    assert code == 0
    assert int(out.split("nanosec: ")[1].split()[0]) % 50_000_000 == 0
    assert tool(topic, "echo", "/clock", "--timeout", "0.2", "--filter", "False")[:2] == (0, "")
    assert "is not an expression of Python" in tool.refused(topic, "echo", STATES, "--filter", "m.")
