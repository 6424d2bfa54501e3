"""Values of parameters, by the rules of ``launch_ros``: what they become, and what ROS would refuse."""

from pathlib import Path

import numpy as np
import pytest

from drake_twin.errors import InputError
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitutions.text_substitution import TextSubstitution
from drake_twin.ros2.parameter_values import typed_as, typed_value


def text(value):
    return TextSubstitution(text=value)


@pytest.fixture
def context():
    return LaunchContext()


def checked(context, found, expected, refused):
    assert found == expected
    assert type(found) is type(expected)
    assert [item.what for item in context.refused] == ([f"it is {refused}"] if refused else [])


@pytest.mark.parametrize(
    ("value", "expected", "refused"),
    [
        (1, 1, ""),
        ("1", "1", ""),  # text stays text
        (text("1"), 1, ""),  # a substitution is read as YAML
        ([text("1"), text("2")], 12, ""),  # the parts of one text
        (["a", text("b")], "ab", ""),
        ([1, 2], (1, 2), ""),
        ([1, 2.5], (1.0, 2.5), ""),
        (["a", "b"], ("a", "b"), ""),
        ([[text("1")], [text("2")]], (1, 2), ""),
        ([], (), "an empty list"),
        (text("[]"), (), "an empty list"),
        ([1, "a"], ("1", "a"), "a list of different types, [1, 'a']"),
        ([{"a": 1}], ("{'a': 1}",), "a list of mappings"),
        (np.float64(2.5), 2.5, "a number of NumPy"),
        (Path("/p"), "/p", "a path object, which is not text"),
    ],
)
def test_a_value_of_a_mapping(context, value, expected, refused):
    checked(context, typed_value(context, value, "it"), expected, refused)


def test_text_that_yaml_takes_for_a_mapping_is_advised_to_be_text(context):
    assert typed_value(context, text("a: 1"), "it") == "a: 1"
    (refused,) = context.refused
    assert refused.what.endswith("a mapping; with ParameterValue(…, value_type=str) it is taken as text")


def test_what_no_parameter_can_have_is_an_error(context):
    with pytest.raises(InputError, match="it is None, of type NoneType"):
        typed_value(context, None, "it")


@pytest.mark.parametrize(
    ("value", "kind", "expected", "refused"),
    [
        (1, int, 1, ""),
        (1, None, 1, ""),
        (1, float, 1.0, "1, and not of type float"),
        (1, str, "1", "1, and not of type str"),
        ("2", int, 2, "'2', and not of type int"),
        ("[1, 2]", list[int], (1, 2), "'[1, 2]', and not of type list[int]"),
        (text("1"), str, "1", ""),
        (text("1"), float, 1.0, ""),
        ([text("1"), "5"], int, 15, ""),
        (["1", "5"], int, 15, "a list, and not of type int"),
        ([1, 2], list[int], (1, 2), ""),
        ([1, 2.5], list[float], (1.0, 2.5), ""),
        ([1, 2.5], None, (1.0, 2.5), ""),
        ([1, [text("2")]], list[int], (1, 2), ""),
        ([1, 2], list[str], ("1", "2"), "[1, 2], and not of type list[str]"),
    ],
)
def test_a_value_of_a_type(context, value, kind, expected, refused):
    checked(context, typed_as(context, value, kind, "it"), expected, refused)


@pytest.mark.parametrize(("value", "kind"), [("a", int), (True, float), (1.5, list[int]), ([1.5], list[int])])
def test_what_cannot_be_of_the_type_is_an_error(context, value, kind):
    with pytest.raises(InputError):
        typed_as(context, value, kind, "it")
