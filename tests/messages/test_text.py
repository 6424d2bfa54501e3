"""Messages as ``ros2 topic echo`` and Python in ROS 2 print them."""

import numpy as np
import pytest

from drake_twin import messages
from drake_twin.messages.text import call_text, field_names, message_text, plain_data


def test_a_message_is_printed_as_yaml_field_by_field():
    point = messages.Point(1.0, -2.5, 0.0)
    assert message_text(point) == "x: 1.0\ny: -2.5\nz: 0.0\n---"
    assert message_text(point, flow_style=True) == "{x: 1.0, y: -2.5, z: 0.0}\n---"


def test_fields_of_fields_keep_their_order_and_letters():
    message = messages.message("std_msgs/msg/String", {"data": "größe"})
    assert message_text(message) == "data: größe\n---"
    stamped = messages.Vector3Stamped(messages.header(1.5, "base"), messages.Vector3(0.0, 0.0, 1.0))
    assert [*plain_data(stamped)] == ["header", "vector"]
    assert plain_data(stamped)["header"] == {"stamp": {"sec": 1, "nanosec": 500_000_000}, "frame_id": "base"}


def test_constants_and_the_member_of_an_empty_message_are_no_fields():
    assert field_names(messages.message("std_msgs/msg/Empty", {})) == []
    status = messages.message("action_msgs/msg/GoalStatus", {})  # with the constants STATUS_UNKNOWN and others
    assert field_names(status) == ["goal_info", "status"]


@pytest.mark.parametrize(
    ("value", "longest", "expected"),
    [
        (np.arange(4), None, [0, 1, 2, 3]),
        (np.arange(4), 4, [0, 1, 2, 3]),
        (np.arange(5), 4, [0, 1, 2, 3, "..."]),
        ("abcd", 4, "abcd"),
        ("abcde", 4, "abcd..."),
        ({"a": (1, 2, 3)}, 2, {"a": [1, 2, "..."]}),
        (np.float64(0.5), None, 0.5),
        (None, None, None),
    ],
)
def test_what_is_longer_is_cut(value, longest, expected):
    assert plain_data(value, longest) == expected


def test_a_message_in_python_is_a_call_of_its_class():
    assert call_text(messages.message("std_msgs/msg/String", {"data": "hi"})) == "std_msgs.msg.String(data='hi')"
    array = messages.float64_multi_array([1.0, 2.0])
    layout = "std_msgs.msg.MultiArrayLayout(dim=[], data_offset=0)"
    assert call_text(array) == f"std_msgs.msg.Float64MultiArray(layout={layout}, data=[1.0, 2.0])"
    assert call_text([1, "a"]) == "[1, 'a']"
    assert call_text(messages.Point) == repr(messages.Point)
