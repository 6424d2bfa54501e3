"""Plain data as annotated types: each value is what its type says, or an error has its path and the valid choices."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from math import inf, nan
from typing import Any, Literal, NamedTuple

import pytest

from drake_twin.typed_data import Reader, field_types, misfit


class Colour(Enum):
    RED = "red"
    BLUE = "blue"


@dataclass(frozen=True)
class Point:
    x: float
    name: str = ""


@dataclass(frozen=True)
class Everything:
    points: tuple[Point, ...] = ()
    pair: tuple[float, str] = (0.0, "")
    by_name: Mapping[str, int] = field(default_factory=dict)
    colour: Colour = Colour.RED
    flag: bool = False
    maybe: float | None = None
    numbers: tuple[float, ...] | Mapping[str, Any] = ()


class Named(NamedTuple):
    x: float


def error(path, message, **more):
    return ValueError(".".join(map(str, path)), message, more.get("valid"))


def test_each_value_is_what_its_type_says():
    data = {
        "points": [{"x": "1e-3"}, {"x": 2, "name": "two"}],
        "pair": [1, "a"],
        "by_name": {"one": 1.0, 2: 2},
        "colour": "blue",
        "flag": True,
        "maybe": None,
        "numbers": {"x": {"y": [1]}},
    }
    read = Reader(error).read(Everything, data)
    assert read == Everything(
        (Point(0.001), Point(2.0, "two")), (1.0, "a"), {"one": 1, "2": 2}, Colour.BLUE, True, None, {"x": {"y": [1]}}
    )
    assert [type(value) for value in (read.points[1].x, read.by_name["one"])] == [float, int]
    assert Reader(error).read(Everything, {"numbers": [1, 2], "maybe": 3}).numbers == (1.0, 2.0)


@pytest.mark.parametrize(
    ("data", "path", "message", "valid"),
    [
        ([], "", "[] is not a mapping", None),
        ({"pont": 1}, "pont", "unknown entry", [*field_types(Everything)]),
        ({"points": [{"x": 1}, {"name": "a"}]}, "points.1", "the entry 'x' is missing", None),
        ({"points": {}}, "points", "{} is not a list", None),
        ({"points": [{"x": inf}]}, "points.0.x", "inf is not a finite number", None),
        ({"points": [{"x": True}]}, "points.0.x", "True is not a finite number", None),
        ({"points": [{"x": 0, "name": 1}]}, "points.0.name", "1 is not text", None),
        ({"pair": [1]}, "pair", "[1] has 1 elements, but 2 are needed", None),
        ({"by_name": {"a": 1.5}}, "by_name.a", "1.5 is not a whole number", None),
        ({"by_name": {"a": inf}}, "by_name.a", "inf is not a whole number", None),
        ({"by_name": {"a": True}}, "by_name.a", "True is not a whole number", None),
        ({"by_name": [1]}, "by_name", "[1] is not a mapping", None),
        ({"colour": "green"}, "colour", "unknown value 'green'", ["red", "blue"]),
        ({"flag": "yes"}, "flag", "'yes' is neither true nor false", None),
        ({"maybe": "a"}, "maybe", "'a' is not a finite number", None),
        ({"numbers": 3}, "numbers", "3 is not a list", None),
    ],
)
def test_what_does_not_fit_has_its_path_and_what_is_valid(data, path, message, valid):
    with pytest.raises(ValueError) as caught:
        Reader(error).read(Everything, data)
    assert caught.value.args == (path, message, valid)


def test_a_reader_may_take_numbers_for_text_and_numbers_that_are_not_finite():
    class Lenient(Reader):
        are_finite = False
        texts_of_numbers = True
        largest = 100

    assert Lenient(error).read(Point, {"x": inf, "name": 1.5}) == Point(inf, "1.5")
    assert Lenient(error).read(Point, {"x": 1, "name": True}) == Point(1.0, "true")
    with pytest.raises(ValueError, match="100 is not a number"):
        Lenient(error).read(Point, {"x": 100})


@pytest.mark.parametrize(
    ("kind", "value", "wanted"),
    [
        (float, 1, None),
        (float, nan, None),
        (float, True, "a number"),
        (float, 10**400, "a number"),
        (int, True, "a whole number"),
        (bool, 1, "true or false"),
        (str, 1, "text"),
        (None, 0, "None"),
        (float | None, None, None),
        (float | None, "a", "a number"),
        (tuple[float, float], (1, 2.0), None),
        (tuple[float, float], (1,), "2 numbers"),
        (tuple[float, float], [1, 2], "2 numbers"),
        (tuple[int, str], ("a", 1), "a list of such values"),
        (tuple[int, ...], (1, 2), None),
        (tuple[int, ...], (1, "a"), "a list of such values"),
        (tuple[()], (), None),
        (list[int], [1, "a"], "a list of such values"),
        (Mapping[str, float], {"a": "b"}, "a mapping of names to such values"),
        (dict[str, Any], {"a": object()}, None),
        (Literal["a", "b"], "a", None),
        (Literal["a", "b"], "c", "one of a, b"),
        (Point, Point(1.0), None),
        (Point, 1, "of this kind"),
        (Any, object(), None),
    ],
)
def test_a_value_fits_its_type_or_what_is_wanted_is_said(kind, value, wanted):
    assert misfit(kind, value) == wanted


def test_a_list_counts_as_a_tuple_where_that_is_asked_for():
    assert misfit(tuple[float, ...], [1.0], (tuple, list)) is None
    assert misfit(Mapping[str, tuple[int, int]], {"a": [1, 2]}, (tuple, list)) is None


def test_the_types_of_fields_are_those_of_dataclasses_and_named_tuples():
    assert field_types(Point) == {"x": float, "name": str}
    assert field_types(Named) == {"x": float}
