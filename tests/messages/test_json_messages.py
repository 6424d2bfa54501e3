"""Messages as JSON."""

import json
import math

import pytest

from drake_twin.messages.interface_types import make, serialize
from drake_twin.messages.json_messages import from_json, json_data, json_schema


def test_a_message_there_and_back():
    fields = {"name": ["left"], "position": [0.5], "header": {"stamp": {"sec": 2}, "frame_id": "base"}}
    message = make("sensor_msgs/msg/JointState", fields)
    assert json.loads(json_data(message)) == {
        "header": {"stamp": {"sec": 2, "nanosec": 0}, "frame_id": "base"},
        "name": ["left"],
        "position": [0.5],
        "velocity": [],
        "effort": [],
    }
    assert serialize(from_json("sensor_msgs/msg/JointState", json_data(message))) == serialize(message)


def test_what_json_has_no_number_for_is_null():
    message = make("sensor_msgs/msg/JointState", {"position": [math.nan, math.inf, 1.0]})
    assert json.loads(json_data(message))["position"] == [None, None, 1.0]


@pytest.mark.parametrize("data", [b"{", b"[" * 100_000, b"[1]", b'{"nothing": 1}', b'{"position": "x"}', b"\xff"])
def test_what_is_not_such_a_message_is_refused(data):
    with pytest.raises(ValueError):
        from_json("sensor_msgs/msg/JointState", data)


def test_the_schema_has_the_type_of_each_field():
    schema = json_schema("rcl_interfaces/srv/SetParameters_Request")
    value = schema["properties"]["parameters"]["items"]["properties"]["value"]["properties"]
    assert schema["properties"]["parameters"]["type"] == "array"
    assert value["type"] == {"type": "integer"}
    assert value["bool_value"] == {"type": "boolean"}
    assert value["double_array_value"] == {"type": "array", "items": {"type": "number"}}
    assert value["string_value"] == {"type": "string"}
    assert json_schema("std_srvs/srv/Trigger_Request")["properties"] == {}
