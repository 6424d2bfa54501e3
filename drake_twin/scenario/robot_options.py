"""A robot as a Python program gives it: lists and arrays for tuples, paths for files, numbers for texts."""

import dataclasses
import functools
import inspect
import types
import typing
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypedDict, TypeVar

from drake_twin.description.package_index import absolute_path
from drake_twin.description.robot_description import Vector3
from drake_twin.errors import InputError
from drake_twin.scenario import Robot
from drake_twin.typed_data import field_types

_Method = TypeVar("_Method", bound=Callable[..., Any])


class RobotOptions(TypedDict, total=False):
    """The fields of `Robot` but its name and model, each as a program may give it."""

    xacro_args: Mapping[str, object] | None
    xyz: Iterable[float]
    rpy: Iterable[float]
    namespace: str | None
    frame_prefix: str | None
    controllers: str | Path | Iterable[str | Path]
    active_controllers: Iterable[str] | None
    inactive_controllers: Iterable[str]
    initial_positions: Mapping[str, float] | None
    self_collision: bool | None
    collision: str
    contact: str
    remappings: Mapping[str, str] | None
    stamped_topics: Iterable[str]
    without_repairs: Iterable[str]
    added_controllers: Mapping[str, Mapping[str, Any]] | None
    unconfigured_controllers: Iterable[str]
    bridged: Mapping[str, str] | None
    controller_parameters: Mapping[str, Mapping[str, Any]] | None
    friction: float | None
    joint_friction: Mapping[str, float] | None
    command_delay: float
    measurement_delay: float
    noise: float
    publish_frequency: float


def address(file: str | Path) -> str:
    """Return a file's address as in a scenario: an address unchanged, a path made absolute."""
    return str(file) if "://" in str(file) else absolute_path(file)


def text(value: object) -> str:
    """Return a value of an argument of xacro or of a launch file as its text."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def robot_of(name: str, model: str | Path, options: RobotOptions) -> Robot:
    """Return the robot that a program describes.

    Raises:
        InputError: If a value cannot be used.
    """
    kinds = field_types(Robot)
    values = {
        option: converted(kinds[option], value, f"{option} of robot {name!r}") for option, value in options.items()
    }
    given = {option: value for option, value in values.items() if value is not None}
    if "controllers" in given:
        given["controllers"] = tuple(map(address, given["controllers"]))
    return Robot(name, address(model), **given)


def vector3(values: Iterable[float], what: str) -> Vector3:
    """Return three numbers, which ``what`` names in an error.

    Raises:
        InputError: If they are not three numbers.
    """
    try:
        x, y, z = () if isinstance(values, str) else map(float, values)
    except (TypeError, ValueError):
        raise InputError(f"{what}: {values!r} is not three numbers") from None
    return x, y, z


def converted(kind: Any, value: Any, what: str) -> Any:
    """Return a value as an annotated type wants it; None where the default is meant.

    Args:
        kind: The type of a field of plain data.
        value: What a program gives.
        what: What it is, for an error.

    Raises:
        InputError: If it cannot be converted.
    """
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if value is None:
        return None
    if origin is types.UnionType:
        return converted(next(item for item in arguments if item is not type(None)), value, what)
    try:
        if origin is tuple and arguments[-1] is Ellipsis:
            items = [value] if isinstance(value, str | Path) else value
            return tuple(converted(arguments[0], item, what) for item in items)
        if kind == Vector3:
            return vector3(value, what)
        if origin is Mapping:
            return {str(key): converted(arguments[1], item, what) for key, item in dict(value).items()}
        return float(value) if kind is float else text(value) if kind is str else value
    except (TypeError, ValueError):
        wanted = {tuple: "a list of names", Mapping: "a mapping"}.get(origin, "a number")
        raise InputError(f"{what}: {value!r} is not {wanted}") from None


def takes_robot_options(method: _Method) -> _Method:
    """Let a method that takes `RobotOptions` be seen with the names and defaults of `Robot`'s fields, as by ``help``.

    A wrong name is a TypeError, as where they were written out.
    """
    own = inspect.signature(method)
    before = [item for item in own.parameters.values() if item.kind is not inspect.Parameter.VAR_KEYWORD]
    options = [
        inspect.Parameter(
            item.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=None if item.default is dataclasses.MISSING else item.default,
            annotation=RobotOptions.__annotations__[item.name],
        )
        for item in dataclasses.fields(Robot)
        if item.name in RobotOptions.__annotations__
    ]
    signature = own.replace(parameters=[*before, *options])

    @functools.wraps(method)
    def call(*arguments: Any, **named: Any) -> Any:
        signature.bind(*arguments, **named)
        return method(*arguments, **named)

    call.__signature__ = signature  # type: ignore[attr-defined]
    return call  # type: ignore[return-value]
