"""A controller's ``ros__parameters`` as a typed, frozen dataclass, checked as generate_parameter_library does.

A parameters class is a frozen dataclass whose fields are named like the parameters. Types are ``bool``, ``int``,
``float``, ``str``, tuples of these, another parameters class for a nested one (``gains.p`` or a mapping), and
``Mapping[str, C]`` for one nested class per joint.

A field's ``metadata`` may hold ``lower`` and ``upper`` (inclusive), ``above`` (exclusive), ``choices``, ``not_empty``,
``unsupported``: why a value other than the default has no effect in the twin, and ``not_of_files``: why a parameters
file cannot give it, as it is for plugins and scenarios. ``of_joints`` marks a mapping whose keys are beside the class's
other parameters, as ``constraints.<joint>.goal`` beside ``constraints.goal_time``; ``keys`` names the parameter that
lists the keys which a mapping has in ROS in any case.

Values that depend on each other are checked in ``__post_init__``, which raises `ParameterError`.

The class variables ``read_only`` and ``live`` say what can be set (`drake_twin.description.declared_parameters`).
``dialects`` holds other parameters classes, with other names for the same: one is used where a file
has one of the names in its class variable ``signs``, and its ``translated()`` returns the class's own instance.
"""

import dataclasses
import typing
from collections.abc import Iterator, Mapping
from math import isnan
from typing import Any

from drake_twin.description.controllers_yaml import ControllerParameters, nested
from drake_twin.findings import Cause, Finding, Kind
from drake_twin.typed_data import Reader, ValuePath, field_types, is_required

# Parameters of every node of ROS 2, and those that ros2_control itself reads for any controller.
_OF_EVERY_NODE = frozenset(
    (
        "use_sim_time",
        "update_rate",
        "is_async",
        "type",
        "params_file",
        "fallback_controllers",
        "start_type_description_service",
    )
)


class ParameterError(ValueError):
    """Raised by a parameters class in ``__post_init__`` for values that contradict each other.

    Args:
        message: What is wrong.
        path: The parameter it is about.
    """

    def __init__(self, message: str, *path: str | int):
        super().__init__(message)
        self.message = message
        self.path = path


def read_parameters(kind: type, controller: ControllerParameters) -> tuple[Any, tuple[Finding, ...]]:
    """Read a controller's parameters.

    Args:
        kind: The parameters class.
        controller: The entry in the parameters file.

    Returns:
        An instance of ``kind``, and a finding for each parameter that is unknown or not supported.

    Raises:
        InputError: If a value has the wrong type or is out of bounds, or a required parameter is missing; with file and
            line.
    """
    reader = _Reader(controller)
    values = nested(controller.parameters)
    for dialect in getattr(kind, "dialects", ()):
        if dialect.signs & values.keys():
            return reader.read_class(dialect, values, ()).translated(), tuple(reader.findings)
    return reader.read_class(kind, values, ()), tuple(reader.findings)


def parameter_names(kind: type, prefix: str = "") -> Iterator[tuple[str, "dataclasses.Field[Any]", Any]]:
    """Yield each parameter of a class: its name with dots, its field and its type; ``<joint>`` stands for any name."""
    for item in dataclasses.fields(kind):
        annotation = field_types(kind)[item.name]
        inner = typing.get_args(annotation)[1] if typing.get_origin(annotation) is Mapping else annotation
        if dataclasses.is_dataclass(inner):
            name = "" if "of_joints" in item.metadata else f"{item.name}."
            joint = "<joint>." if inner is not annotation else ""
            yield from parameter_names(typing.cast(type, inner), f"{prefix}{name}{joint}")
        else:
            yield prefix + item.name, item, annotation


class _Reader(Reader):
    """Read the parameters of a controller, and find those that are not used."""

    are_finite = False
    largest = 2**63  # what ROS's parameters hold

    def __init__(self, controller: ControllerParameters):
        super().__init__(lambda path, message, **more: controller.error(message, *path, **more))
        self.findings: list[Finding] = []
        self._controller = controller

    def read_class(self, kind: type, value: Any, path: ValuePath) -> Any:
        if not isinstance(value, dict):
            raise self.error(path, f"{value!r} is not a mapping of parameters")
        fields = {item.name: item for item in dataclasses.fields(kind)}
        for name in [name for name, item in fields.items() if "of_joints" in item.metadata]:
            value = _of_joints_apart(value, name, fields)
        for name in value:
            if name not in fields and not (not path and name in _OF_EVERY_NODE):
                unknown = f": unknown parameter {_dotted(*path, name)!r}: it is ignored"
                self._find(unknown, (*path, name), common=unknown)
        given = {}
        for name, item in fields.items():
            if name not in value:
                if is_required(item):
                    raise self.error(path, f"the parameter {_dotted(*path, name)!r} is missing")
                continue
            place = path if "of_joints" in item.metadata else (*path, name)
            if "not_of_files" in item.metadata and self._controller.sources:
                why = f": {_dotted(*place)} is ignored: {item.metadata['not_of_files']}"
                self._find(why, next(_leaves(value[name], place)))
                continue
            given[name] = self.read(field_types(kind)[name], value[name], place)
            if given[name] == () and is_required(item):
                raise self.error((*path, name), "the list is empty")
            self._check_bounds(item, given[name], (*path, name))
            default = item.default if item.default_factory is dataclasses.MISSING else item.default_factory()
            if "unsupported" in item.metadata and not _same(given[name], default):
                self._find(f": {_dotted(*path, name)} is ignored: {item.metadata['unsupported']}", (*path, name))
        try:
            return kind(**given)
        except ParameterError as error:
            raise self.error((*path, *error.path), error.message) from None

    def _find(self, what: str, path: ValuePath, common: str = "") -> None:
        what, place = f"controller {self._controller.name}{what}", self._controller.place(*path)
        self.findings.append(Finding.at(Kind.WARNING, what, place, common=common, cause=Cause.PARAMETER))

    def _check_bounds(self, item: "dataclasses.Field[Any]", value: Any, path: ValuePath) -> None:
        lower, upper, choices = (item.metadata.get(key) for key in ("lower", "upper", "choices"))
        above = item.metadata.get("above")
        if item.metadata.get("not_empty") and not value:
            raise self.error(path, f"{path[-1]} is empty")
        may_be_nan = isinstance(item.default, float) and isnan(item.default)
        for each in value if isinstance(value, tuple) else (value,):
            if isinstance(each, float) and isnan(each) and not may_be_nan:
                raise self.error(path, f"{each!r} is not a number")
            if choices is not None and each not in choices:
                raise self.error(path, f"unknown value {each!r}", value=str(each), valid=choices)
            if above is not None and not each > above:
                raise self.error(path, f"{each!r} is not above {above:g}")
            if lower is not None and not (each >= lower or isnan(each)):
                raise self.error(path, f"{each!r} is below {lower:g}")
            if upper is not None and not (each <= upper or isnan(each)):
                raise self.error(path, f"{each!r} is above {upper:g}")


def _dotted(*path: str | int) -> str:
    return ".".join(map(str, path))


def _leaves(value: Any, path: ValuePath) -> Iterator[ValuePath]:
    """Yield the paths of the values in a mapping; the path itself for another value."""
    if not isinstance(value, dict) or not value:
        yield path
        return
    for key, below in value.items():
        yield from _leaves(below, (*path, key))


def _of_joints_apart(values: dict[str, Any], field: str, fields: Mapping[str, Any]) -> dict[str, Any]:
    """Move parameters below joints' names to the name of their field."""
    named = fields.keys() - {field}
    joints = {name: below for name, below in values.items() if name not in named and isinstance(below, dict)}
    return {name: value for name, value in values.items() if name not in joints} | {field: joints}


def _same(one: Any, other: Any) -> bool:
    return bool(one == other) or (isinstance(one, float) and isinstance(other, float) and isnan(one) and isnan(other))
