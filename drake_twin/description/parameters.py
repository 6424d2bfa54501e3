"""A controller's ``ros__parameters`` as a typed, frozen dataclass, checked as generate_parameter_library does.

A parameters class is a frozen dataclass whose fields are named like the parameters. Types are ``bool``, ``int``,
``float``, ``str``, tuples of these, another parameters class for a nested one (``gains.p`` or a mapping), and
``Mapping[str, C]`` for one nested class per joint.

A field's ``metadata`` may hold ``lower`` and ``upper`` (inclusive), ``above`` (exclusive), ``choices``, ``not_empty``,
``unsupported``: why a value other than the default has no effect in the twin, and ``not_of_files``: why a parameters
file cannot give it, as it is for plugins and scenarios. ``of_joints`` marks a mapping whose keys are beside the class's
other parameters, as ``constraints.<joint>.goal`` beside ``constraints.goal_time``.

Values that depend on each other are checked in ``__post_init__``, which raises `ParameterError`.

A class variable ``dialects`` holds other parameters classes, with other names for the same: one is used where a file
has one of the names in its class variable ``signs``, and its ``translated()`` returns the class's own instance.
"""

import dataclasses
import typing
from collections.abc import Iterator, Mapping
from functools import cache
from math import isnan
from typing import Any

from drake_twin.description.controllers_yaml import ControllerParameters, nested
from drake_twin.findings import Cause, Finding, Kind
from drake_twin.values import yaml_number

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

Path = tuple[str | int, ...]


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
    warnings: list[Finding] = []
    values = nested(controller.parameters)
    for dialect in getattr(kind, "dialects", ()):
        if dialect.signs & values.keys():
            return _read_class(dialect, values, controller, (), warnings).translated(), tuple(warnings)
    return _read_class(kind, values, controller, (), warnings), tuple(warnings)


def parameter_names(kind: type, prefix: str = "") -> Iterator[tuple[str, "dataclasses.Field[Any]", Any]]:
    """Yield each parameter of a class: its name with dots, its field and its type; ``<joint>`` stands for any name."""
    for item in dataclasses.fields(kind):
        annotation = _types(kind)[item.name]
        inner = typing.get_args(annotation)[1] if typing.get_origin(annotation) is Mapping else annotation
        if dataclasses.is_dataclass(inner):
            name = "" if "of_joints" in item.metadata else f"{item.name}."
            joint = "<joint>." if inner is not annotation else ""
            yield from parameter_names(typing.cast(type, inner), f"{prefix}{name}{joint}")
        else:
            yield prefix + item.name, item, annotation


@cache
def _types(kind: type) -> dict[str, Any]:
    return typing.get_type_hints(kind)


def _read_class(kind: type, values: Any, controller: ControllerParameters, path: Path, warnings: list[Finding]) -> Any:
    if not isinstance(values, dict):
        raise controller.error(f"{values!r} is not a mapping of parameters", *path)
    fields = {item.name: item for item in dataclasses.fields(kind)}
    for name in [name for name, item in fields.items() if "of_joints" in item.metadata]:
        values = _of_joints_apart(values, name, fields)
    for name in values:
        if name not in fields and not (not path and name in _OF_EVERY_NODE):
            where = ".".join(map(str, (*path, name)))
            unknown = f": unknown parameter {where!r}: it is ignored"
            what, at = f"controller {controller.name}{unknown}", controller.place(*path, name)
            warnings.append(Finding.at(Kind.WARNING, what, at, common=unknown, cause=Cause.PARAMETER))
    given = {}
    for name, item in fields.items():
        if name not in values:
            if _is_required(item):
                raise controller.error(f"the parameter {'.'.join(map(str, (*path, name)))!r} is missing", *path)
            continue
        place = path if "of_joints" in item.metadata else (*path, name)
        if "not_of_files" in item.metadata and controller.sources:
            what = (
                f"controller {controller.name}: {'.'.join(map(str, place))} is ignored: {item.metadata['not_of_files']}"
            )
            leaf = next(_leaves(values[name], place))
            warnings.append(Finding.at(Kind.WARNING, what, controller.place(*leaf), cause=Cause.PARAMETER))
            continue
        value = _read(_types(kind)[name], values[name], controller, place, warnings)
        if value == () and _is_required(item):
            raise controller.error("the list is empty", *path, name)
        _check_bounds(item, value, controller, (*path, name))
        default = item.default if item.default_factory is dataclasses.MISSING else item.default_factory()
        if "unsupported" in item.metadata and not _same(value, default):
            where = ".".join(map(str, (*path, name)))
            what = f"controller {controller.name}: {where} is ignored: {item.metadata['unsupported']}"
            warnings.append(Finding.at(Kind.WARNING, what, controller.place(*path, name), cause=Cause.PARAMETER))
        given[name] = value
    try:
        return kind(**given)
    except ParameterError as error:
        raise controller.error(error.message, *path, *error.path) from None


def _leaves(value: Any, path: Path) -> Iterator[Path]:
    """Yield the paths of the values in a mapping; the path itself for another value."""
    if not isinstance(value, dict) or not value:
        yield path
        return
    for key, below in value.items():
        yield from _leaves(below, (*path, key))


def _is_required(item: "dataclasses.Field[Any]") -> bool:
    return item.default is dataclasses.MISSING and item.default_factory is dataclasses.MISSING


def _of_joints_apart(values: dict[str, Any], field: str, fields: Mapping[str, Any]) -> dict[str, Any]:
    """Move parameters below joints' names to the name of their field."""
    named = fields.keys() - {field}
    joints = {name: below for name, below in values.items() if name not in named and isinstance(below, dict)}
    return {name: value for name, value in values.items() if name not in joints} | {field: joints}


def _read(annotation: Any, value: Any, controller: ControllerParameters, path: Path, warnings: list[Finding]) -> Any:
    origin, arguments = typing.get_origin(annotation), typing.get_args(annotation)
    if dataclasses.is_dataclass(annotation):
        return _read_class(typing.cast(type, annotation), value, controller, path, warnings)
    if origin is Mapping:
        if not isinstance(value, dict):
            raise controller.error(f"{value!r} is not a mapping", *path)
        return {str(key): _read(arguments[1], item, controller, (*path, key), warnings) for key, item in value.items()}
    if origin is tuple:
        if not isinstance(value, list):
            raise controller.error(f"{value!r} is not a list", *path)
        return tuple(_read(arguments[0], item, controller, (*path, i), warnings) for i, item in enumerate(value))
    is_number = isinstance(value, float) or (
        isinstance(value, int) and not isinstance(value, bool) and abs(value) < 2**63  # what ROS's parameters hold
    )
    if annotation is float:
        number = yaml_number(value) if is_number or isinstance(value, str) else None
        if number is None:
            raise controller.error(f"{value!r} is not a number", *path)
        return number
    if annotation is int and not (is_number and float(value).is_integer()):
        raise controller.error(f"{value!r} is not a whole number", *path)
    if annotation is bool and not isinstance(value, bool):
        raise controller.error(f"{value!r} is neither true nor false", *path)
    if annotation is str and not isinstance(value, str):
        raise controller.error(f"{value!r} is not text", *path)
    return int(value) if annotation is int else value


def _check_bounds(item: "dataclasses.Field[Any]", value: Any, controller: ControllerParameters, path: Path) -> None:
    lower, upper, choices = (item.metadata.get(key) for key in ("lower", "upper", "choices"))
    above = item.metadata.get("above")
    if item.metadata.get("not_empty") and not value:
        raise controller.error(f"{path[-1]} is empty", *path)
    may_be_nan = isinstance(item.default, float) and isnan(item.default)
    for each in value if isinstance(value, tuple) else (value,):
        if isinstance(each, float) and isnan(each) and not may_be_nan:
            raise controller.error(f"{each!r} is not a number", *path)
        if choices is not None and each not in choices:
            raise controller.error(f"unknown value {each!r}", *path, value=str(each), valid=choices)
        if above is not None and not each > above:
            raise controller.error(f"{each!r} is not above {above:g}", *path)
        if lower is not None and not (each >= lower or isnan(each)):
            raise controller.error(f"{each!r} is below {lower:g}", *path)
        if upper is not None and not (each <= upper or isnan(each)):
            raise controller.error(f"{each!r} is above {upper:g}", *path)


def _same(one: Any, other: Any) -> bool:
    return bool(one == other) or (isinstance(one, float) and isinstance(other, float) and isnan(one) and isnan(other))
