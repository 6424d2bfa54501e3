"""Dataclasses beside the standard library's, which are the standard."""

import copy
import dataclasses
import inspect
import pickle
from collections.abc import Callable
from typing import Any, ClassVar

import pytest

from drake_twin.dataclass import dataclass

Decorator = Callable[..., Any]


def classes(make: Decorator) -> dict[str, type]:
    """The same classes, made by a decorator."""

    @make
    class Plain:
        """A point."""

        x: float
        y: float = 0.0

    @make(frozen=True)
    class Frozen:
        """A row."""

        name: str
        of_class: ClassVar[int] = 3
        values: list[int] = dataclasses.field(default_factory=list)
        kept: int = dataclasses.field(default=1, repr=False, compare=False)
        unhashed: int = dataclasses.field(default=2, hash=False)
        of_name: str = dataclasses.field(init=False, default="")
        later: dict[str, int] = dataclasses.field(init=False, default_factory=dict)
        last: int = dataclasses.field(default=4, kw_only=True)

        def __post_init__(self) -> None:
            object.__setattr__(self, "of_name", f"of {self.name}")

    @make(frozen=True, kw_only=True)
    class ByName:
        a: int = 1
        b: str

    @make(frozen=True)
    class Pair:
        first: object
        second: object

    @make(frozen=True)
    class One:
        self_: int

    @make(frozen=True)
    class Empty:
        """Nothing."""

    @make(frozen=True)
    class OwnMethods:
        x: int

        def __eq__(self, other: object) -> bool:
            return type(other) is type(self)

        def __hash__(self) -> int:
            return 7

        def __repr__(self) -> str:
            return "own"

    @make(frozen=True)
    class OwnEquality:
        x: int

        def __eq__(self, other: object) -> bool:
            return type(other) is type(self)

    @make(eq=False)
    class Thing:
        x: int

    @make(frozen=True, order=True)
    class Ordered:
        x: int

    @make(frozen=True)
    class More(Pair):
        third: int = 3

    @make(frozen=True, kw_only=True)
    class OwnText(More):
        second: object = 5
        fourth: list[int] = dataclasses.field(default_factory=list, compare=False)

        def __repr__(self) -> str:
            return f"{super().__repr__()} and more"

    found = locals()
    return {name: kind for name, kind in found.items() if name != "make"}


OURS, STANDARD = classes(dataclass), classes(dataclasses.dataclass)
VALUES: dict[str, tuple[tuple[Any, ...], dict[str, Any]]] = {
    "Plain": ((1.0,), {}),
    "Frozen": (("n",), {"last": 5}),
    "ByName": ((), {"b": "text"}),
    "Pair": ((1, "two"), {}),
    "One": ((3,), {}),
    "Empty": ((), {}),
    "OwnMethods": ((1,), {}),
    "OwnEquality": ((1,), {}),
    "Thing": ((1,), {}),
    "Ordered": ((1,), {}),
    "More": ((1, 2), {}),
    "OwnText": ((1,), {"third": 4}),
}


def instance(kinds: dict[str, type], name: str) -> Any:
    values, by_name = VALUES[name]
    return kinds[name](*values, **by_name)


def outcome(call: Callable[..., object], *arguments: object) -> object:
    """What a call returns, or the class of its error."""
    try:
        return call(*arguments)
    except Exception as error:
        return type(error)


@pytest.mark.parametrize("name", STANDARD)
def test_a_class_is_as_the_standard_librarys(name):
    ours, standard = OURS[name], STANDARD[name]
    assert str(inspect.signature(ours)) == str(inspect.signature(standard))
    assert ours.__init__.__annotations__ == standard.__init__.__annotations__
    assert ours.__init__.__qualname__ == standard.__init__.__qualname__
    assert ours.__match_args__ == standard.__match_args__
    assert repr(ours.__dataclass_params__) == repr(standard.__dataclass_params__)
    assert (ours.__hash__ is None) == (standard.__hash__ is None)
    assert [field.name for field in dataclasses.fields(ours)] == [field.name for field in dataclasses.fields(standard)]


@pytest.mark.parametrize("name", STANDARD)
def test_an_instance_is_as_the_standard_librarys(name):
    (ours, other), standard = (instance(OURS, name) for _ in range(2)), instance(STANDARD, name)
    if name != "Thing":  # whose text has its address
        assert repr(ours).partition(".<locals>.")[2] == repr(standard).partition(".<locals>.")[2]
    assert (ours == other) == (standard == instance(STANDARD, name))
    assert ours != standard
    assert dataclasses.asdict(ours) == dataclasses.asdict(standard)
    if name != "Thing":
        assert outcome(hash, ours) == outcome(hash, standard)
    assert copy.deepcopy(ours).__dict__ == ours.__dict__
    for field in dataclasses.fields(standard):
        for change in (
            lambda item, name=field.name: setattr(item, name, 0),
            lambda item, name=field.name: delattr(item, name),
        ):
            assert outcome(lambda change=change: change(ours)) == outcome(lambda change=change: change(standard))
    assert outcome(lambda: setattr(ours, "another", 0)) == outcome(lambda: setattr(standard, "another", 0))
    assert ours.__dict__ == standard.__dict__


@pytest.mark.parametrize("values", [(), (1, 2, 3, 4, 5, 6, 7, 8)])
@pytest.mark.parametrize("name", STANDARD)
def test_wrong_arguments_are_refused_in_the_same_words(name, values):
    def refused(kinds: dict[str, type]) -> str | None:
        try:
            kinds[name](*values)
        except TypeError as error:
            return str(error)
        return None

    assert refused(OURS) == refused(STANDARD)


def test_instances_are_equal_as_long_as_what_is_compared_is():
    frozen = OURS["Frozen"]
    assert frozen("n", kept=1) == frozen("n", kept=2)
    assert frozen("n", unhashed=1) != frozen("n", unhashed=2)
    assert frozen("n", [1]) != frozen("n", [2])
    first, second = frozen("n"), frozen("n")
    assert first.values is not second.values
    pair = OURS["Pair"]
    assert len({pair(1, 2), pair(1, 2), pair(1, 3)}) == 2
    assert dataclasses.replace(pair(1, 2), second=5) == pair(1, 5)


def test_a_text_that_would_hold_itself_ends():
    items: list[object] = []
    pair = OURS["Pair"](items, 1)
    items.append(pair)
    assert repr(pair).endswith("Pair(first=[...], second=1)")


def test_a_standard_dataclass_inherits_from_one():
    @dataclasses.dataclass(frozen=True)
    class More(OURS["Pair"]):  # type: ignore[misc]
        third: int = 3

    more = More(1, 2)
    assert (more.first, more.second, more.third) == (1, 2, 3)
    with pytest.raises(dataclasses.FrozenInstanceError, match="'first'"):
        more.first = 5
    with pytest.raises(TypeError, match="cannot inherit non-frozen dataclass from a frozen one"):
        dataclasses.dataclass(type("Other", (OURS["Pair"],), {}))
    with pytest.raises(TypeError, match="cannot inherit non-frozen dataclass from a frozen one"):
        dataclass(type("Other", (OURS["Pair"],), {}))


@dataclass(frozen=True)
class Sent:
    x: int


def test_an_instance_that_was_sent_is_whole_before_any_was_made():
    """Which ``pickle`` makes without ``__init__``."""
    received = Sent.__new__(Sent)
    received.__dict__["x"] = 2
    assert (repr(received), received == Sent(2), hash(received)) == ("Sent(x=2)", True, hash(Sent(2)))
    assert pickle.loads(pickle.dumps(received)) == Sent(2)


def test_methods_are_compiled_when_they_are_looked_up():
    @dataclass(frozen=True)
    class Point:
        x: int

    def are_functions() -> list[bool]:
        return [inspect.isfunction(vars(Point)[name]) for name in ("__init__", "__repr__", "__eq__", "__hash__")]

    assert are_functions() == [False] * 4
    point = Point(1)
    assert are_functions() == [True, False, False, False]
    assert (point == Point(1), hash(point), repr(point)) == (True, hash((1,)), f"{Point.__qualname__}(x=1)")
    assert are_functions() == [True] * 4
