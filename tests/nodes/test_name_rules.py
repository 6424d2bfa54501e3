"""``rclpy.validate_*`` and ``rclpy.expand_topic_name``: the outcomes of rclpy 7.1 (rcl 9.2) for these names."""

import pytest

from drake_twin.nodes.rclpy import exceptions
from drake_twin.nodes.rclpy.expand_topic_name import expand_topic_name
from drake_twin.nodes.rclpy.validate_full_topic_name import validate_full_topic_name
from drake_twin.nodes.rclpy.validate_namespace import validate_namespace
from drake_twin.nodes.rclpy.validate_node_name import validate_node_name
from drake_twin.nodes.rclpy.validate_parameter_name import validate_parameter_name
from drake_twin.nodes.rclpy.validate_topic_name import validate_topic_name

IN_TOPICS = "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}'"
IN_PATHS = "must not contain characters other than alphanumerics, '_', or '/'"
BRACES = "topic name must not have unmatched (unbalanced) curly braces '{}'"
TILDE = "topic name must not have tilde '~' unless it is the first character"
IN_WORDS = "substitution name must not contain characters other than alphanumerics or '_'"
WRONG = [
    (validate_full_topic_name, "a", "topic name must be absolute, it must lead with a '/'", 0),
    (validate_full_topic_name, "", "topic name must not be empty", 0),
    (validate_full_topic_name, "/a/", "topic name must not end with a '/'", 2),
    (validate_full_topic_name, "/", "topic name must not end with a '/'", 0),
    (validate_full_topic_name, "//a", "topic name must not contain repeated '/'", 1),
    (validate_full_topic_name, "/a b", f"topic name {IN_PATHS}", 2),
    (validate_full_topic_name, "/a/{b}", f"topic name {IN_PATHS}", 3),
    (validate_full_topic_name, "/1a", "topic name must not have a token that starts with a number", 1),
    (validate_full_topic_name, "/" + "a" * 247, "topic length should not exceed '255U - 8U'", 246),
    (validate_namespace, "a", "namespace must be absolute, it must lead with a '/'", 0),
    (validate_namespace, "", "namespace must not be empty", 0),
    (validate_namespace, "/a/", "namespace must not end with a '/', unless only a '/'", 2),
    (validate_namespace, "//a", "namespace must not contain repeated '/'", 1),
    (validate_namespace, "/a~", f"namespace {IN_PATHS}", 2),
    (validate_namespace, "/a/1b", "namespace must not have a token that starts with a number", 3),
    (validate_namespace, "/" + "a" * 245, "namespace should not exceed 'RMW_NAMESPACE_MAX_NAME_LENGTH'", 244),
    (validate_node_name, "1a", "node name must not start with a number", 0),
    (validate_node_name, "", "node name must not be empty", 0),
    (validate_node_name, "a/b", "node name must not contain characters other than alphanumerics or '_'", 1),
    (validate_node_name, "a" * 256, "node name length should not exceed '255'", 254),
    (validate_topic_name, "1a", "topic name token must not start with a number", 0),
    (validate_topic_name, "a/1b", "topic name token must not start with a number", 2),
    (validate_topic_name, "~/1", "topic name token must not start with a number", 2),
    (validate_topic_name, "", "topic name must not be empty string", 0),
    (validate_topic_name, "a/b c", IN_TOPICS, 3),
    (validate_topic_name, "é", IN_TOPICS, 0),
    (validate_topic_name, "a/", "topic name must not end with a forward slash", 1),
    (validate_topic_name, "{n", BRACES, 0),
    (validate_topic_name, "a{", BRACES, 1),
    (validate_topic_name, "ab}c", BRACES, 2),
    (validate_topic_name, "/~", TILDE, 1),
    (validate_topic_name, "{a~}", TILDE, 2),
    (validate_topic_name, "{{a}}", IN_WORDS, 1),
    (validate_topic_name, "a{b c}", IN_WORDS, 3),
    (validate_topic_name, "{1n}", "substitution name must not start with a number", 1),
]
RIGHT = {
    validate_full_topic_name: ("/a", "/a/b", "/" + "a" * 246),
    validate_namespace: ("/", "/a", "/" + "a" * 244),
    validate_node_name: ("a", "a" * 255),
    validate_topic_name: ("a", "~/a", "~a", "~1", "a//b", "{n}a", "{}", "{a}{b}", "_a"),
    validate_parameter_name: ("a",),
}


@pytest.mark.parametrize(("function", "name", "text", "index"), WRONG)
def test_what_is_wrong_with_a_name_and_where(function, name, text, index):
    with pytest.raises(exceptions.NameValidationException) as found:
        function(name)
    assert (found.value.error_msg, found.value.invalid_index) == (text, index)


def test_names_that_are_right():
    assert all(function(name) is True for function, names in RIGHT.items() for name in names)


def test_errors_have_a_class_for_each_kind_of_name():
    for function, names, kind in (
        (validate_topic_name, {}, exceptions.InvalidTopicNameException),
        (validate_full_topic_name, {"is_service": True}, exceptions.InvalidServiceNameException),
        (validate_topic_name, {"is_service": True}, exceptions.InvalidServiceNameException),
        (validate_namespace, {}, exceptions.InvalidNamespaceException),
        (validate_node_name, {}, exceptions.InvalidNodeNameException),
        (validate_parameter_name, {}, exceptions.InvalidParameterException),
    ):
        with pytest.raises(kind):
            function("", **names)


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        (("chatter", "talker", "/ns"), "/ns/chatter"),
        (("~/a", "talker", "/ns"), "/ns/talker/a"),
        (("~", "talker", "/"), "/talker"),
        (("~a", "t", "/"), "/ta"),
        (("/abs", "talker", "/ns"), "/abs"),
        (("{node}/a", "talker", "/ns"), "/ns/talker/a"),
        (("{namespace}/x", "t", "/q"), "/q/x"),
        (("{ns}", "t", "/"), "/"),
        (("a//b", "t", "/"), "/a//b"),
    ],
)
def test_full_names(arguments, wanted):
    assert expand_topic_name(*arguments) == wanted


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("{unknown}/a", "t", "/ns"), "topic name '{unknown}/a' is invalid: unknown substitution: {unknown}"),
        (("a b", "t", "/"), f"topic name 'a b' is invalid: {IN_TOPICS}"),
        (("a", "1n", "/"), "node name '1n' is invalid: node name must not start with a number"),
        (("a", "t", "ns"), "node namespace 'ns' is invalid: namespace must be absolute, it must lead with a '/'"),
    ],
)
def test_names_that_cannot_be_expanded(arguments, text):
    with pytest.raises(ValueError) as found:
        expand_topic_name(*arguments)
    assert str(found.value) == text
