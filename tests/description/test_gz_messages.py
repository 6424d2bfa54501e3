"""Messages of gz in the text format of Protocol Buffers, as the ROS messages of ros_gz's bridge."""

import pytest

from drake_twin import messages
from drake_twin.description.gz_messages import (
    GZ_TYPES,
    UnknownMessageError,
    field_leaves,
    gz_type,
    message_leaves,
    ros_fields,
)
from drake_twin.description.protobuf_text import read_fields, read_value
from drake_twin.messages.interface_types import make


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ("", {}),
        ("data: true", {"data": ["true"]}),
        ("linear: {x: 1.5}, angular { z: -2 };", {"linear": [{"x": [1.5]}], "angular": [{"z": [-2]}]}),
        ("a <b: 1> # a comment\n a: {b: 2}", {"a": [{"b": [1]}, {"b": [2]}]}),
        ("v: [1, 2.5, 0x10] v: -3", {"v": [1, 2.5, 16, -3]}),
        (r"""s: "a\n\"b\"" 'c' t: '\x41\102'""", {"s": ['a\n"b"c'], "t": ["AB"]}),
        ("e: 1e-3 f: 2.5f g: .5 h: inf", {"e": [1e-3], "f": [2.5], "g": [0.5], "h": [float("inf")]}),
    ],
)
def test_text_is_read_as_fields(text, fields):
    assert read_fields(text) == fields


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("data 1", "':' is missing after 'data'"),
        ("a: {b: 1", "'}' is missing"),
        ("a: }", "'}' is not a value"),
        ("a:", "a value is missing"),
        ("3: 4", "'3' is not a field"),
        ("a: 'open", '"\'" is out of place'),
        ("a: [1 2]", "']' is missing"),
        ("a: {" * 40, "it is too deep"),
    ],
)
def test_other_text_is_refused(text, problem):
    with pytest.raises(ValueError, match=r".") as raised:
        read_fields(text)
    assert str(raised.value) == problem


def test_one_value_is_read_alone():
    assert read_value("-7.5") == -7.5
    with pytest.raises(ValueError, match="'2' is left after the value"):
        read_value("1 2")


@pytest.mark.parametrize("name", GZ_TYPES)
def test_each_field_is_one_of_its_ros_type(name):
    """The text of all fields makes a ROS message, which has all that the text says."""
    texts = {"number": "1.5", "number of 4 bytes": "1.5", "whole number": "3", "true or false": "true", "text": "'t'"}

    def text(kind):
        return " ".join(
            f"{field}: {texts[found.removesuffix('[]')]}"
            if found.removesuffix("[]") in texts
            else f"{field} {{{text(found)}}}"
            for field, (_, found) in GZ_TYPES[kind].fields.items()
        )

    message = make(GZ_TYPES[name].ros, ros_fields(name, text(name)))
    leaves = message_leaves(name, text(name))
    assert all(leaf.fits(message, 0.0) for leaf in leaves)
    assert not any(leaf.fits(make(GZ_TYPES[name].ros, {}), 0.0) for leaf in leaves)


def test_a_type_may_have_the_name_of_ignition():
    assert gz_type("ignition.msgs.Twist") == gz_type("gz.msgs.Twist") == "Twist"
    with pytest.raises(UnknownMessageError, match=r"no message type 'gz.msgs.Twits'. Did you mean 'Twist'"):
        gz_type("gz.msgs.Twits")


def test_what_is_not_given_is_zero_in_a_whole_message_and_nothing_in_a_field():
    twist = make("geometry_msgs/msg/Twist", {"linear": {"x": 1.0, "y": 0.5}})
    assert not all(leaf.fits(twist, 1e-8) for leaf in message_leaves("Twist", "linear: {x: 1}"))
    assert all(leaf.fits(twist, 1e-8) for leaf in message_leaves("Twist", "linear: {x: 1, y: 0.5}"))
    assert all(leaf.fits(twist, 1e-8) for leaf in field_leaves("Twist", "linear.x", "1"))
    assert not all(leaf.fits(twist, 1e-8) for leaf in field_leaves("Twist", "linear", "{x: 1}"))
    assert not all(leaf.fits(twist, 1e-8) for leaf in field_leaves("Twist", "linear.y", "0.4"))
    assert all(leaf.fits(twist, 0.11) for leaf in field_leaves("Twist", "linear.y", "0.4"))


def test_of_a_repeated_field_one_value_has_to_be_there_and_of_a_whole_message_all_in_their_order():
    heard = messages.message("ros_gz_interfaces/msg/StringVec", {"data": ["a", "b"]})
    assert all(leaf.fits(heard, 0.0) for leaf in field_leaves("StringMsg_V", "data", "'b'"))
    assert not all(leaf.fits(heard, 0.0) for leaf in field_leaves("StringMsg_V", "data", "'c'"))
    assert all(leaf.fits(heard, 0.0) for leaf in message_leaves("StringMsg_V", "data: 'a' data: 'b'"))
    assert not all(leaf.fits(heard, 0.0) for leaf in message_leaves("StringMsg_V", "data: ['b', 'a']"))


def test_numbers_of_4_bytes_are_compared_as_such():
    (leaf,) = field_leaves("Float", "data", "2.3")
    assert leaf.fits(make("std_msgs/msg/Float32", {"data": 2.299999952316284}), 0.0)
    (double,) = field_leaves("Double", "data", "2.3")
    assert not double.fits(make("std_msgs/msg/Float64", {"data": 2.299999952316284}), 1e-8)


@pytest.mark.parametrize(
    ("kind", "field", "text", "problem"),
    [
        ("Int32", "data", "1.5", "'data' is 1.5, which is not a whole number"),
        ("Boolean", "data", "3", "'data' is 3, which is not a true or false"),
        ("StringMsg", "data", "word", "'data' is 'word', which is not a text"),
        ("Double", "data", "'1'", "'data' is '1', which is not a number"),
        ("Twist", "linear", "1", "'linear' is 1, which is not a message in braces"),
        ("Twist", "linear.x.y", "1", "'x' of the field 'linear.x.y' has no fields"),
        ("Twist", "lineal", "1", "the twin knows no field 'lineal' of gz.msgs.Twist. Did you mean 'linear'?"),
    ],
)
def test_a_value_of_another_kind_is_refused(kind, field, text, problem):
    with pytest.raises((ValueError, UnknownMessageError)) as raised:
        field_leaves(kind, field, text)
    assert str(raised.value) == problem


def test_a_field_is_given_once():
    with pytest.raises(ValueError, match="the field 'data' is given 2 times"):
        ros_fields("Double", "data: 1 data: 2")
