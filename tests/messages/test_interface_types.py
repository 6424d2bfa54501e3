"""Types as they go over a wire, against hashes and bytes that others have published or made."""

import struct

import numpy as np
import pytest

from drake_twin import messages
from drake_twin.messages.interface_types import (
    default_values,
    definition,
    deserialize,
    fields_of,
    known_names,
    known_packages,
    knows,
    make,
    make_response,
    serialize,
    type_hash,
    type_names,
)
from drake_twin.messages.store import add_definition, default_in


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        # rmw_zenoh's docs/design.md and ros2 topic info --verbose of Jazzy, as published.
        ("std_msgs/msg/String", "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"),
        ("sensor_msgs/msg/JointState", "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"),
        ("std_srvs/srv/Trigger", "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f"),
    ],
)
def test_hashes_are_those_of_ros(name, wanted):
    assert type_hash(name) == wanted


def test_a_service_of_a_package_that_the_twin_does_not_use():
    """The hash is that of rmw_zenoh's docs/design.md."""
    wanted = "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"
    assert type_hash("example_interfaces/srv/AddTwoInts") == wanted


def test_a_users_own_message_and_action():
    add_definition("my_msgs/msg/Speeds", "float64[] wheels\nstring name\n")
    add_definition("my_msgs/action/Drive", "my_msgs/Speeds speeds\n---\nbool done\n---\nfloat64 way\n")
    goal = make("my_msgs/action/Drive_SendGoal_Request", {"goal": {"speeds": {"wheels": [1.0], "name": "a"}}})
    assert deserialize("my_msgs/action/Drive_SendGoal_Request", serialize(goal)).goal.speeds.name == "a"
    with pytest.raises(ValueError, match="2 parts"):
        add_definition("my_msgs/action/Other", "bool a\n---\nbool b\n")


def test_bytes_are_cdr():
    """XCDR1, OMG formal/08-01-07: header 00 01 00 00, then aligned little-endian values."""
    message = make("std_srvs/srv/SetBool_Response", {"success": True, "message": "hi"})
    assert serialize(message) == b"\0\1\0\0" + b"\1\0\0\0" + struct.pack("<I", 3) + b"hi\0"
    assert serialize(make("std_srvs/srv/Trigger_Request", {})) == b"\0\1\0\0" + b"\0"


def test_what_is_not_given_has_ros_default_values():
    request = make("controller_manager_msgs/srv/SwitchController_Request", {"activate_controllers": ["a"]})
    assert (request.strictness, request.activate_asap, request.timeout.sec) == (0, False, 0)
    assert request.activate_controllers == ["a"]
    assert messages.message("geometry_msgs/msg/Twist", {}).linear.x == 0.0


def test_unknown_types_are_refused():
    with pytest.raises(ValueError, match="unknown type 'a/msg/B'"):
        type_hash("a/msg/B")


def test_a_text_holds_those_of_the_messages_in_it():
    text = definition("control_msgs/msg/DynamicJointState")
    assert "MSG: control_msgs/InterfaceValue" in text
    assert "float64[] values" in text


def test_fields_that_are_left_out_have_the_values_of_their_definitions():
    pose = make("geometry_msgs/msg/PoseStamped", {"pose": {"orientation": {"z": 1.0}}}).pose  # float64 w 1
    assert (pose.orientation.z, pose.orientation.w) == (1.0, 1.0)
    assert make("geometry_msgs/msg/Pose", {"orientation": {"w": 0.0}}).orientation.w == 0.0
    assert make("control_msgs/msg/MotionPrimitive", {}).type == -1  # int8 type -1
    assert make("simulation_interfaces/srv/StepSimulation_Request", {}).steps == 1  # uint64 steps 1


def test_defaults_of_a_definition_are_numbers_flags_texts_and_lists_without_their_comments():
    """The grammar is that of design.ros2.org's "Interface definition using .msg / .srv / .action files"."""
    add_definition(
        "my_msgs/msg/Defaults",
        """int8 count -3  # three
float64 ratio 0.5
bool on true
bool off 0
string single 'it is # no comment'
string double "say \\"hi\\""
int32[] few [1, 2]
int32 LIMIT=9
string none
""",
    )
    found = default_values("my_msgs/msg/Defaults")
    assert found.pop("few").tolist() == [1, 2]
    assert found == {
        "count": -3,
        "ratio": 0.5,
        "on": True,
        "off": False,
        "single": "it is # no comment",
        "double": 'say "hi"',
    }
    made = make("my_msgs/msg/Defaults", {"ratio": 0.25})
    assert (made.count, made.ratio, made.off, made.few.tolist(), made.none) == (-3, 0.25, False, [1, 2], "")


def test_defaults_without_quotes():
    _, fields = fields_of("std_msgs/msg/String")
    assert default_in("string data hello # a comment", fields) == {"data": "hello"}
    assert default_in('string data "', fields) == {"data": '"'}


@pytest.mark.parametrize(
    ("service", "field"),
    [
        ("std_srvs/srv/Trigger", "message"),
        ("gazebo_msgs/srv/SpawnEntity", "status_message"),
        ("simulation_interfaces/srv/StepSimulation", "result.error_message"),
    ],
)
def test_a_reason_stands_where_a_response_has_a_place_for_one(service, field):
    def text(reason):
        place = make_response(service, {}, reason)
        for name in field.split("."):
            place = getattr(place, name)
        return place

    assert (text("too late"), text("")) == ("too late", "")
    assert make_response("std_srvs/srv/Empty", {}, "too late").__msgtype__ == "std_srvs/srv/Empty_Response"


def test_all_types_of_packages_are_known_by_their_names():
    names = type_names()
    assert names == sorted({*names})
    for name in ("sensor_msgs/msg/Imu", "moveit_msgs/srv/GetPlanningScene", "nav2_msgs/action/NavigateToPose"):
        assert name in names
        assert knows(name)
    assert not knows("my_msgs/msg/Nothing")


def test_a_packages_messages_services_and_actions_are_listed_without_their_parts():
    assert known_names("std_srvs", "srv") == ["Empty", "SetBool", "Trigger"]
    assert {"FollowJointTrajectory", "GripperCommand"} <= {*known_names("control_msgs", "action")}
    assert {"Twist", "PoseStamped"} <= {*known_names("geometry_msgs", "msg")}
    assert not any("_" in name for name in known_names("control_msgs", "action"))
    assert {"std_srvs", "geometry_msgs"} <= known_packages()


@pytest.mark.parametrize(
    ("kind", "values", "refused"),
    [
        ("uint8", np.array([0, 255], np.uint8), False),
        ("uint8", np.array([0, 255], np.int64), False),  # of another type, which has more: each is looked at
        ("uint8", np.array([256], np.int64), True),
        ("int16", np.array([-129, 5], np.int16), False),
        ("uint16", np.array([-1], np.int8), True),
        ("uint8", np.array([True]), True),
    ],
)
def test_arrays_of_whole_numbers(kind, values, refused):
    def made():
        name = kind.replace("uint", "UInt").replace("int", "Int")
        return make(f"std_msgs/msg/{name}MultiArray", {"data": values})

    if refused:
        with pytest.raises(ValueError, match=f"is not a {kind}"):
            made()
    else:
        assert (made().data.dtype, made().data.tolist()) == (kind, values.tolist())


def test_a_picture_is_not_looked_at_number_by_number(monkeypatch):
    monkeypatch.setattr("drake_twin.messages.field_values.base_value", None)
    assert make("std_msgs/msg/UInt8MultiArray", {"data": np.zeros(1 << 20, np.uint8)}).data.size == 1 << 20
