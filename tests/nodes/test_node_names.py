"""Names of topics and services as nodes give them, in full or refused; "Topic and Service name mapping to DDS"."""

import pytest

from drake_twin.nodes.rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from drake_twin.nodes.rclpy.names import check_name, expanded_name


@pytest.mark.parametrize(
    ("name", "full"),
    [
        ("/chatter", "/chatter"),
        ("chatter", "/left/chatter"),
        ("a/b_2", "/left/a/b_2"),
        ("~/chatter", "/left/talker/chatter"),
        ("~", "/left/talker"),
        ("{node}/chatter", "/left/talker/chatter"),
        ("{ns}/chatter", "/left/chatter"),
    ],
)
def test_a_name_is_below_its_namespace_or_its_node(name, full):
    assert expanded_name(name, "/left", "talker") == full


@pytest.mark.parametrize(
    ("name", "index"), [("", 0), ("1a", 0), ("a/", 1), ("a/2", 2), ("a b", 1), ("a-b", 1), ("a~", 1)]
)
def test_what_is_no_name_is_refused_with_the_place_of_what_is_wrong(name, index):
    for is_service, kind in ((False, InvalidTopicNameException), (True, InvalidServiceNameException)):
        with pytest.raises(kind) as refused:
            check_name(name, "/", "talker", is_service=is_service)
        assert (refused.value.name, refused.value.invalid_index) == (name, index)
    with pytest.raises(InvalidTopicNameException):  # without another word it is a topic's
        check_name(name, "/", "talker")
