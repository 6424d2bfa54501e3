import pytest

from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.ros2.evaluation import active
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.launch_context import LaunchContext


def entity(children=(), **attributes):
    return Entity("tag", Place("x.launch.xml", 3), attributes, [Entity(child, Place("x", 4)) for child in children])


@pytest.mark.parametrize(
    ("value", "data_type", "expected"),
    [
        ("5", str, "5"),
        ("5", int, 5),
        ("0.5", float, 0.5),
        ("True", bool, True),
        ("yes", bool, True),
        ("0", bool, False),
        ("[1, 2]", list[int], [1, 2]),
        ("[1, 2]", list[float], [1.0, 2.0]),
        ("{a: 1}", None, "{a: 1}"),
        ("$(var x)", int, "$(var x)"),
    ],
)
def test_an_attribute_is_read_as_a_type(value, data_type, expected):
    result = entity(name=value).get_attr("name", data_type=data_type)
    assert result == expected
    assert type(result) is type(expected)


def test_a_separator_splits_a_list():
    attributes = {"v": "1;2", "v-sep": ";"}
    assert Entity("tag", Place("x"), attributes).get_attr("v", data_type=list[int]) == [1, 2]


def test_underscores_and_hyphens_are_the_same():
    assert entity(launch_prefix="x").get_attr("launch-prefix") == "x"
    assert "launch-prefix" in entity(launch_prefix="x")


def test_children_are_found_by_their_tag():
    element = entity(["a", "b", "a"])
    assert [child.type_name for child in element.get_attr("a", data_type=list[Entity])] == ["a", "a"]
    assert element.get_attr("c", data_type=list[Entity], optional=True) is None
    assert element.children[0].parent is element


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        (lambda element: element.get_attr("other"), r"x.launch.xml:3: <tag>: the attribute 'other' is missing"),
        (lambda element: element.get_attr("c", data_type=list[Entity]), "the attribute 'c' is missing"),
        (
            lambda element: element.get_attr("name", data_type=int, can_be_str=False),
            "'x', which is not of type int",
        ),
        (lambda element: element.get_attr("name", data_type=bool, can_be_str=False), "neither true nor false"),
        (lambda element: element.assert_entity_completely_parsed(), "unknown attribute 'name'"),
    ],
)
def test_a_wrong_attribute_is_refused_with_its_line(call, reason):
    with pytest.raises(InputError, match=reason):
        call(entity(name="x"))


@pytest.mark.parametrize(
    ("value", "data_type", "expected", "refused"),
    [
        ("'1'", str, "'1'", ""),
        (True, bool, True, ""),
        ("no", bool, "no", ""),
        (True, str, "true", "True, and not of type str"),
        (0, bool, False, "0, and not of type bool"),
        ([1, 2], list[float], [1.0, 2.0], "[1, 2], and not of type list[float]"),
        ([1, 2.5], None, [1.0, 2.5], "a list of different types, [1, 2.5]"),
    ],
)
def test_values_of_yaml_keep_their_types(value, data_type, expected, refused):
    context = LaunchContext()
    with active(context):
        result = Entity("tag", Place("x", 3), {"name": value}, typed=True).get_attr("name", data_type=data_type)
    assert result == expected
    assert type(result) is type(expected)
    found = [f"<tag>: name is {refused}"] if refused else []
    assert [item.what for item in context.refused] == found


def test_children_that_nothing_asks_for_are_refused():
    element = entity(["a", "b"])
    element.children_named("a")
    with pytest.raises(InputError, match=r"<b>: not an element of <tag>. Valid: a"):
        element.assert_entity_completely_parsed()
