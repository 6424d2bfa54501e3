"""A controller's parameters as its node declares them in ROS: types, texts, ranges, and which of them can be set when.

Upstream declares them by generate_parameter_library; the sentences that refuse a value are its own and rclcpp's. A
parameters class (`drake_twin.description.parameters`) has what they follow from. Two class variables hold patterns of
names (as in `fnmatch`, with ``<joint>`` for an item of a list): ``read_only`` of what cannot be set, and ``live`` of
what an active controller follows at once. Others take effect when the controller is configured next.
"""

import dataclasses
import inspect
import math
import re
import sys
import typing
from collections.abc import Iterator, Mapping
from fnmatch import fnmatchcase
from functools import cache
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import parameter_names
from drake_twin.messages.parameter_value import NOT_SET, type_of
from drake_twin.typed_data import field_types, is_required

JOINT = "<joint>"
_SCALARS = {bool: 1, int: 2, float: 3, str: 4}  # rcl_interfaces/msg/ParameterType
_ARRAYS = {bool: 6, int: 7, float: 8, str: 9}
_NAMES = (
    *("not set", "bool", "integer", "double", "string", "byte_array"),
    *("bool_array", "integer_array", "double_array", "string_array"),
)
_LARGEST = 2**63 - 1


@dataclass(frozen=True)
class DeclaredParameter:
    """A parameter of a node.

    Attributes:
        name: Its name, with dots.
        type: Its ``rcl_interfaces/msg/ParameterType``.
        value: Its value: lists are tuples.
        description: What it means.
        constraints: What its range does not say.
        lower: Its least value; None without one.
        upper: Its greatest value; None without one.
        choices: The valid values; empty without such.
        is_filled: Whether it must not be empty.
        is_read_only: Whether it cannot be set.
        is_live: Whether an active controller follows it at once.
    """

    name: str
    type: int
    value: Any
    description: str = ""
    constraints: str = ""
    lower: float | None = None
    upper: float | None = None
    choices: tuple[str, ...] = ()
    is_filled: bool = False
    is_read_only: bool = False
    is_live: bool = False

    @property
    def bounds(self) -> tuple[float, float] | None:
        """The least and the greatest value, as generate_parameter_library declares them; None without a range."""
        if self.lower is None and self.upper is None:
            return None
        largest = sys.float_info.max
        low, high = (-_LARGEST - 1, _LARGEST) if self.is_whole else (-largest, largest)
        return (low if self.lower is None else self.lower, high if self.upper is None else self.upper)

    @property
    def is_whole(self) -> bool:
        """Whether its values are whole numbers."""
        return self.type in (2, 7)

    def refusal(self, value: Any) -> str:
        """Return why a value cannot be set, in the words of rclcpp and of generate_parameter_library; empty if it can.

        Args:
            value: The value; a list for an array, None for one without a type.
        """
        if self.is_read_only:
            return f"parameter '{self.name}' cannot be set because it is read-only"
        given = self.type if value == [] and self.type > 4 else type_of(value)
        if given != self.type:
            types = f"of type {{{_NAMES[self.type]}}}, setting it to {{{_NAMES[given]}}}"
            return f"Wrong parameter type, parameter {{{self.name}}} is {types} is not allowed."
        values = value if isinstance(value, list) else [value]
        if self.bounds is not None and any(not _is_within(item, *self.bounds) for item in values):
            kind = "integer" if self.is_whole else "floating point"
            return f"Parameter {{{self.name}}} doesn't comply with {kind} range."
        if self.is_filled and not value:
            return f"Parameter '{self.name}' cannot be empty"
        wrong = [item for item in values if self.choices and item not in self.choices]
        if wrong:
            known = f"is not in the set '{{{', '.join(self.choices)}}}'"
            is_list = isinstance(value, list)
            what = f"Entry '{wrong[0]}' in parameter '{self.name}'" if is_list else f"Parameter '{self.name}'"
            return f"{what} {known}" if is_list else f"{what} with the value '{value}' {known}"
        return ""


def _is_within(value: float, lower: float, upper: float) -> bool:
    return not (value < lower or value > upper)  # NaN is, as in rclcpp


def declared_parameters(values: Any) -> Iterator[DeclaredParameter]:
    """Yield the parameters of an instance of a parameters class.

    Args:
        values: The instance; of those that each item of a list has, it may lack some, which have their defaults.
    """
    kind: Any = type(values)
    read_only, live = (getattr(kind, name, ()) for name in ("read_only", "live"))
    for pattern, item, annotation in parameter_names(kind):
        if "not_of_files" in item.metadata or _type(annotation) == NOT_SET:
            continue
        is_read_only = any(fnmatchcase(pattern, each) for each in read_only)
        is_live = not is_read_only and any(fnmatchcase(pattern, each) for each in live)
        text = parameter_text(kind, pattern).replace("``", "`")
        for name, value in _values(values, pattern, values):
            metadata = item.metadata
            choices = tuple(map(str, metadata.get("choices") or ()))
            yield DeclaredParameter(
                name=name,
                type=_type(annotation),
                value=value,
                description=text,
                constraints=f"one of {', '.join(choices)}" if choices else "",
                lower=_lower(metadata, annotation),
                upper=metadata.get("upper"),
                choices=choices,
                is_filled=bool(metadata.get("not_empty")),
                is_read_only=is_read_only,
                is_live=is_live,
            )


def _type(annotation: Any) -> int:
    if typing.get_origin(annotation) is tuple:
        return _ARRAYS[typing.get_args(annotation)[0]]
    return _SCALARS.get(annotation, NOT_SET)


def _lower(metadata: Mapping[str, Any], annotation: Any) -> float | None:
    above: float | None = metadata.get("above")
    if above is None:
        return metadata.get("lower")
    return above + 1 if annotation is int else math.nextafter(above, math.inf)


def _values(owner: Any, pattern: str, root: Any, done: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the names and values of the parameters with a name in which ``<joint>`` stands for any item."""
    part, _, rest = pattern.partition(".")
    items = {item.name: item for item in dataclasses.fields(owner)}
    if part == JOINT:
        part = next(name for name, item in items.items() if "of_joints" in item.metadata)
        yield from _each(owner, items[part], rest, root, done)
        return
    value, name = getattr(owner, part), f"{done}{part}"
    if not rest:
        if not isinstance(value, Mapping):
            yield name, value
        return
    if rest.startswith(JOINT) and "of_joints" not in items[part].metadata and isinstance(value, Mapping):
        yield from _each(owner, items[part], rest.partition(".")[2], root, f"{name}.")
    else:
        yield from _values(value, rest, root, f"{name}.")


def _each(owner: Any, item: "dataclasses.Field[Any]", rest: str, root: Any, done: str) -> Iterator[tuple[str, Any]]:
    """Yield the values of all items of a mapping, and of those that the list of its metadata has beside."""
    known = getattr(owner, item.name)
    kind: Any = type(owner)
    inner = typing.get_args(field_types(kind)[item.name])[1]
    lacking = [name for name in getattr(root, item.metadata.get("keys", ""), ()) if name not in known]
    can_lack = not any(map(is_required, dataclasses.fields(inner)))
    for key in (*known, *(lacking if can_lack else ())):
        yield from _values(known[key] if key in known else inner(), rest, root, f"{done}{key}.")


@cache
def parameter_text(parameters: type, name: str) -> str:
    """Return what the docstrings of a parameters class say of a parameter, with those of the ones above it."""
    said = [text for kind, attribute in _path(parameters, name) if (text := _attributes(kind).get(attribute))]
    return "; ".join(text.rstrip(".") for text in said)


def _path(parameters: type, name: str) -> Iterator[tuple[type, str]]:
    """Yield the class and attribute of each part of a parameter's name."""
    kind: Any = parameters
    for part in name.split("."):
        if part == JOINT:
            for item in dataclasses.fields(kind):
                if "of_joints" in item.metadata:
                    kind = typing.get_args(typing.get_type_hints(kind)[item.name])[1]
                    break
            continue
        yield kind, part
        kind = typing.get_type_hints(kind)[part]
        if typing.get_origin(kind) is Mapping:
            kind = typing.get_args(kind)[1]


def _attributes(kind: type) -> dict[str, str]:
    """Return the texts of attributes in the docstrings of a class and its bases."""
    found: dict[str, str] = {}
    for each in reversed(kind.__mro__):
        _, _, section = inspect.cleandoc(each.__doc__ or "").partition("Attributes:\n")  # Python 3.13 indents less
        for entry in re.split(r"\n(?=    \w+: )", "\n" + section):
            attribute, colon, text = entry.strip().partition(": ")
            if colon and attribute.isidentifier():
                found[attribute] = " ".join(text.split())
    return found
