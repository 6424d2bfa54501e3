"""Golden vectors, without a network."""

from dataclasses import replace

import pytest

from drake_twin.errors import InputError
from drake_twin.wires.rmw_zenoh_format import (
    NO_HASH,
    PUBLISHER,
    SERVICE,
    SUBSCRIPTION,
    GraphEntity,
    Node,
    Qos,
    any_type_key,
    attachment,
    gid,
    read_attachment,
    read_token,
    topic_key,
)
from drake_twin.wires.ros_names import dds_type, domain_of_environment

STRING = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"  # rmw_zenoh, docs/design.md
ADD = "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"


def test_tokens_are_read():
    """rmw_zenoh, docs/design.md, "Graph Cache", and tokens of this format's own."""
    text = (
        "@ros2_lv/2/8b20917502ee955ac4476e0266340d5c/0/10/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/"
        "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18/::,7:,:,:,,"
    )
    expected = GraphEntity(PUBLISHER, "/talker", "/chatter", "std_msgs/msg/String", STRING, Qos(depth=7), gid(text))
    assert read_token(text) == expected
    assert read_token(text.replace("::,7:", "::,x:")) is None
    node = Node(domain=7, session="12", number=3, name="publisher", namespace="/hall/robot_1")
    assert read_token(node.token()) == GraphEntity("NN", "/hall/robot_1/publisher")
    latched = node.endpoint_token(4, PUBLISHER, "/hall/tf_static", "tf2_msgs/msg/TFMessage", "h", Qos(True, 1))
    expected = GraphEntity(PUBLISHER, node="/hall/robot_1/publisher", name="/hall/tf_static", qos=Qos(True, 1))
    assert read_token(latched) == replace(expected, type="tf2_msgs/msg/TFMessage", hash="h", gid=gid(latched))
    assert read_token(latched).latched
    for text in ("@ros2_lv/2/x/0/0/XX/%/%/listener", "@ros2_lv/2", "@ros2_lv/2/x/0/10/MP/%/%/talker/%chatter/T", ""):
        assert read_token(text) is None


def test_announced_quality_of_service_is_read():
    """The numbers are those of rmw/types.h: best effort 2, transient local 1, keep all 2, manual by topic 3."""
    assert Qos.of("::,:,:,:,,") == Qos(depth=42)
    every = Qos(True, 0, False, 1_500_000_000, 2_000_000_000, is_manual=True, lease=7)
    assert Qos.of("2:1:2,3:1,500000000:2,0:3,0,7") == every
    assert Qos.of(str(Qos(True, 5))) == Qos(True, 5)


def test_examples_of_the_design_document():
    """rmw_zenoh, docs/design.md, "Graph Cache", which leaves out of a QoS what is rmw_zenoh's own default.

    Reliable, volatile and keep last may be written all the same: ``keyexpr_to_qos`` reads both.
    """
    listener = Node(domain=2, session="aac3178e146ba6f1fc6e6a4085e77f21", number=0, name="listener")
    assert listener.token() == "@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/0/NN/%/%/listener"
    assert listener.endpoint_token(10, SUBSCRIPTION, "/chatter", "std_msgs/msg/String", STRING, Qos()) == (
        "@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/10/MS/%/%/listener/%chatter/std_msgs::msg::dds_::String_/"
        "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18/1:2:1,10:,:,:,,"
    )
    talker = Node(domain=2, session="8b20917502ee955ac4476e0266340d5c", number=0, name="talker")
    assert talker.endpoint_token(10, PUBLISHER, "/chatter", "std_msgs/msg/String", STRING, Qos(depth=7)) == (
        "@ros2_lv/2/8b20917502ee955ac4476e0266340d5c/0/10/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/"
        "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18/1:2:1,7:,:,:,,"
    )
    server = Node(domain=2, session="f9980ee0495eaafb3e38f0d19e2eae12", number=0, name="add_two_ints_server")
    service = "example_interfaces/srv/AddTwoInts"
    assert server.endpoint_token(10, SERVICE, "/add_two_ints", service, ADD, Qos()) == (
        "@ros2_lv/2/f9980ee0495eaafb3e38f0d19e2eae12/0/10/SS/%/%/add_two_ints_server/%add_two_ints/"
        "example_interfaces::srv::dds_::AddTwoInts_/"
        "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a/1:2:1,10:,:,:,,"
    )


def test_key_of_a_topic():
    """rmw_zenoh, docs/design.md, "Topic and Service name mapping"."""
    assert topic_key(0, "/chatter", "std_msgs/msg/String", STRING) == (
        "0/chatter/std_msgs::msg::dds_::String_/RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
    )


def test_names_in_namespaces_have_no_slash_in_a_token():
    node = Node(domain=7, session="12", number=3, name="controller_manager", namespace="/hall/robot_1")
    assert node.token() == "@ros2_lv/7/12/3/3/NN/%/%hall%robot_1/controller_manager"
    token = node.endpoint_token(
        4, SERVICE, "/hall/robot_1/controller_manager/list", "a_msgs/srv/List", NO_HASH, Qos(transient_local=True)
    )
    assert token == (
        "@ros2_lv/7/12/3/4/SS/%/%hall%robot_1/controller_manager/%hall%robot_1%controller_manager%list"
        "/a_msgs::srv::dds_::List_/TypeHashNotSupported/1:1:1,10:,:,:,,"
    )


@pytest.mark.parametrize(
    ("qos", "text"),
    [
        (Qos(is_reliable=False), "2:2:1,10:,:,:,,"),
        (Qos(depth=0), "1:2:2,:,:,:,,"),
        (Qos(deadline=250_000_000, lifespan=2_000_000_005), "1:2:1,10:0,250000000:2,5:,,"),
        (Qos(is_manual=True, lease=3 * 10**9), "1:2:1,10:,:,:3,3,0"),
    ],
)
def test_the_quality_of_service_in_a_token(qos, text):
    """In the order of rmw_zenoh_cpp's ``qos_to_keyexpr``, with the numbers of rmw/types.h."""
    assert str(qos) == text
    assert Qos.of(text) == qos


def test_a_key_keeps_the_slashes_within_a_name():
    assert topic_key(12, "/robot_1/tf_static", "tf2_msgs/msg/TFMessage", NO_HASH) == (
        "12/robot_1/tf_static/tf2_msgs::msg::dds_::TFMessage_/TypeHashNotSupported"
    )
    assert any_type_key(12, "/robot_1/cmd_vel") == "12/robot_1/cmd_vel/*/*"


def test_types_of_actions():
    assert dds_type("control_msgs/action/FollowJointTrajectory_SendGoal") == (
        "control_msgs::action::dds_::FollowJointTrajectory_SendGoal_"
    )


def test_attachment_as_zenoh_serializes_it():
    """int64, int64, and 16 bytes after their number (attachment_helpers.cpp, zenoh's serialization format)."""
    source = bytes(range(16))
    packed = attachment(1, 1_500_000_000_000_000_002, source)
    assert packed.hex() == "0100000000000000" + "0200167b0d12d114" + "10" + "000102030405060708090a0b0c0d0e0f"
    assert read_attachment(packed) == (1, 1_500_000_000_000_000_002, source)


@pytest.mark.parametrize("data", [b"", b"\x00" * 32, b"\x00" * 33, b"\x00" * 41])
def test_bytes_that_are_no_attachment(data):
    with pytest.raises(ValueError, match=rf"an attachment of {len(data)} bytes, but rmw_zenoh's has 33"):
        read_attachment(data)


def test_gid_is_the_hash_of_the_token():
    """XXH3 of the empty text is 99aa06d3014798d86001c324468d497f (xxHash's tests); rmw_zenoh writes low64 first."""
    pytest.importorskip("xxhash")
    assert gid("").hex() == "7f498d4624c30160d8984701d306aa99"


@pytest.mark.parametrize(("text", "domain"), [("", 0), ("0", 0), (" 42 ", 42), ("232", 232)])
def test_domain(monkeypatch, text, domain):
    monkeypatch.setenv("ROS_DOMAIN_ID", text)
    assert domain_of_environment() == domain


@pytest.mark.parametrize("text", ["233", "-1", "1.5", "seven", "²"])
def test_a_domain_that_is_none(monkeypatch, text):
    monkeypatch.setenv("ROS_DOMAIN_ID", text)
    with pytest.raises(InputError, match=rf"^ROS_DOMAIN_ID={text}: a ROS domain is a whole number from 0 to 232\.$"):
        domain_of_environment()
