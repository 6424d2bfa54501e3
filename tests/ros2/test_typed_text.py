"""What texts of launch files stand for, by the rules of ``launch.utilities.type_utils``."""

import pytest

from drake_twin.errors import InputError
from drake_twin.ros2.typed_text import as_scalar, is_of_type, item_type, type_name, typed_items, typed_text


@pytest.mark.parametrize(
    ("value", "kind", "expected"),
    [
        (1, int, True),
        (1, float, False),  # ROS takes no int for a float
        (True, int, True),  # and Python's bool is an int
        (1.5, float, True),
        ("a", str, True),
        ("a", int, False),
        (None, None, False),
        ({"a": 1}, None, False),
        (1.5, None, True),
        ([1, 2], list[int], True),
        ([1, 2.0], list[int], False),
        ([1, "a"], list[int], False),
        (1, list[int], False),
        ([1, 2], None, True),
        (["a", 1], None, False),
        (["a", "b"], None, True),
        ([], None, True),
        ([[1]], None, False),
    ],
)
def test_which_values_are_of_a_type(value, kind, expected):
    assert is_of_type(value, kind) is expected


@pytest.mark.parametrize(("value", "kind"), [("$(var x)", int), ([1, "$(var x)"], list[int]), (["$(var x)", 2], None)])
def test_a_text_may_hold_a_substitution(value, kind):
    assert is_of_type(value, kind, can_be_str=True) is True
    assert is_of_type(value, kind) is False


@pytest.mark.parametrize(
    ("text", "kind", "expected"),
    [
        ("1", None, 1),
        ("1.0", None, 1.0),
        ("true", None, True),
        ("[1, 2]", None, [1, 2]),
        ("", None, ""),
        ("<robot/>", None, "<robot/>"),
        ("1", str, "1"),
        ("1", float, 1.0),
        ("1", bool, True),
        ("0", bool, False),
        ("on", bool, True),
        ("[a, b]", list[str], ["a", "b"]),
    ],
)
def test_what_a_text_stands_for(text, kind, expected):
    found = typed_text(text, kind)
    assert (found.value, found.refused) == (expected, "")
    assert type(found.value) is type(expected)


@pytest.mark.parametrize(
    ("text", "kind", "value", "refused"),
    [
        ("[1, 2.5]", None, [1.0, 2.5], "a list of different types, [1, 2.5]"),
        ("[1, a]", None, ["1", "a"], "a list of different types, [1, 'a']"),
        ("{a: 1}", None, "{a: 1}", "text that YAML takes for a mapping"),
        ("[[1]]", None, "[[1]]", "text that YAML takes for a list of lists or mappings"),
        ("null", None, "null", "text that YAML takes for nothing"),
        ("a: {", None, "a: {", "text that is not valid YAML"),
        ("[1, 2]", list[float], [1.0, 2.0], "[1, 2], and not of type list[float]"),
        ("[1, 2, 3, 4, 5, 6]", list[str], list("123456"), "[1, 2, 3, 4, 5, …], and not of type list[str]"),
    ],
)
def test_what_ros_refuses_is_read_with_the_reason(text, kind, value, refused):
    found = typed_text(text, kind)
    assert (found.value, found.refused) == (value, refused)


@pytest.mark.parametrize(
    ("text", "kind"),
    [("a", int), ("1.5", int), ("x", float), ("2", bool), ("1", list[int]), ("[a]", list[int]), ("1", dict)],
)
def test_what_cannot_be_of_the_type_is_an_error(text, kind):
    with pytest.raises(InputError):
        typed_text(text, kind)


@pytest.mark.parametrize(
    ("text", "kind"), [("$(var x)", int), ("$(var x)", bool), ("$(var x)", list[int]), ("a: {", None)]
)
def test_with_substitutions_a_text_stays_text(text, kind):
    found = typed_text(text, kind, can_be_str=True)
    assert (found.value, found.refused) == (text, "")


@pytest.mark.parametrize(
    ("items", "kind", "expected", "is_refused"),
    [
        ([1, 2], None, [1, 2], False),
        ([1, 2], int, [1, 2], False),
        ([1, 2], float, [1.0, 2.0], True),
        ([1, 2.5], None, [1.0, 2.5], True),
        ([1, "a"], None, ["1", "a"], True),
        ([1, "2"], int, [1, 2], True),
    ],
)
def test_items_become_a_list_of_one_type(items, kind, expected, is_refused):
    found = typed_items(items, kind)
    assert found.value == expected
    assert list(map(type, found.value)) == list(map(type, expected))
    assert bool(found.refused) is is_refused


@pytest.mark.parametrize(("value", "kind"), [(1.5, int), (True, int), (True, float), (1, bool)])
def test_a_value_that_another_type_cannot_hold_is_an_error(value, kind):
    with pytest.raises(InputError, match=f"is not of the parameter's type, {kind.__name__}"):
        as_scalar(value, kind)


def test_types_and_their_items():
    assert [item_type(kind) for kind in (list[int], list, int, None)] == [int, str, None, None]
    assert [type_name(kind) for kind in (int, list[int])] == ["int", "list[int]"]
