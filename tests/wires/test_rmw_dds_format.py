"""Samples of DDS that are a message's bytes, and CycloneDDS's configuration for one interface."""

import xml.etree.ElementTree as ET

import pytest

from drake_twin.wires.rmw_dds_format import configuration, sample_type

pytest.importorskip("cyclonedds", reason="the extra 'test' has it")
HELLO = b"\x00\x01\x00\x00\x06\x00\x00\x00hello\x00"


def test_a_sample_is_its_bytes():
    kind = sample_type("std_msgs/msg/String")
    assert kind(HELLO).serialize() == HELLO
    assert kind.deserialize(bytearray(HELLO)).data == HELLO
    assert sample_type("std_msgs/msg/String") is kind


def test_what_ends_without_a_message_is_an_empty_sample():
    """CycloneDDS hands out a key where a writer leaves; ROS's topics have none."""
    kind = sample_type("std_msgs/msg/String")
    sample = kind.deserialize_key(b"\x00\x01\x00\x00")
    assert isinstance(sample, kind)
    assert sample.data == b""


def test_a_type_that_is_unknown_is_an_error():
    with pytest.raises(ValueError, match="Nothing"):
        sample_type("std_msgs/msg/Nothing")


@pytest.mark.parametrize("multicast", [True, False])
def test_one_interface_and_peers_on_it_without_multicast(multicast):
    domain = ET.fromstring(configuration("192.0.2.1", multicast=multicast)).find("Domain")
    (interface,) = domain.findall("General/Interfaces/NetworkInterface")
    assert interface.attrib == {"address": "192.0.2.1", "multicast": "true" if multicast else "false"}
    assert domain.findtext("General/AllowMulticast") == ("default" if multicast else "false")
    peers = [peer.get("address") for peer in domain.findall("Discovery/Peers/Peer")]
    assert peers == ([] if multicast else ["192.0.2.1"])
