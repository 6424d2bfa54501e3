"""Parameters of nodes: values with ROS's typing rules, and parameter files."""

from __future__ import annotations

import os
import typing
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.errors import InputError
from drake_twin.ros2.launched import ParameterText, Scalar
from drake_twin.ros2.launched import ParameterValue as Value
from drake_twin.ros2.packages import AbsentError, absent_package_in, lasting_folder
from drake_twin.ros2.substitution import (
    SomeSubstitutionsType,
    Substitution,
    normalize_to_list_of_substitutions,
    perform,
    perform_substitutions,
)

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext

_SCALARS = (bool, int, float, str, bytes)


class ParameterValue:
    """A parameter's value, read as a type.

    Args:
        value: a number, text, a substitution, or a list of them.
        value_type: ``bool``, ``int``, ``float``, ``str`` or a list of one of them (``List[float]``); None for what
            YAML takes the text for.
    """

    def __init__(self, value: Any, *, value_type: Any = None):
        self.value = value
        self.value_type = value_type

    def evaluate(self, context: LaunchContext) -> Value:
        """The value.

        Raises:
            InputError: the text is not of the type.
        """
        if self.value_type is None:
            return typed_value(context, self.value, "this parameter")
        if isinstance(self.value, list | tuple) and typing.get_origin(self.value_type) is None:
            return _as_type(perform(context, self.value), self.value_type)  # parts of one text
        if isinstance(self.value, list | tuple) and not any(isinstance(item, Substitution) for item in self.value):
            return _items_as(self.value, self.value_type)
        if isinstance(self.value, bool | int | float):
            return _as_type(self.value, self.value_type)
        return _as_type(perform(context, self.value), self.value_type)


class Parameter(ParameterValue):
    """A parameter: name and value."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, *, value_type: Any = None):
        super().__init__(value, value_type=value_type)
        self.name = normalize_to_list_of_substitutions(name)

    def evaluate_pair(self, context: LaunchContext) -> tuple[str, Value]:
        """Name and value."""
        return perform_substitutions(context, self.name), self.evaluate(context)


class ParameterFile:
    """A YAML file of parameters.

    Args:
        param_file: the file.
        allow_substs: whether ``$(var x)`` and the like are filled in.
    """

    def __init__(self, param_file: Any, *, allow_substs: Any = False):
        param_file = os.fsdecode(param_file) if isinstance(param_file, bytes) else param_file
        self.param_file = normalize_to_list_of_substitutions(param_file)
        self.allow_substs = allow_substs

    def evaluate(self, context: LaunchContext) -> Path:
        """The file; one with its substitutions filled in, where they are allowed."""
        content = self.read(context)
        return content if isinstance(content, Path) else write_rewritten(context, content)

    def read(self, context: LaunchContext) -> Path | ParameterText:
        """The file, or its text where that differs from the file.

        Raises:
            InputError: it cannot be read, and there are substitutions to fill in.
        """
        from drake_twin.ros2.substitution_text import parse_substitution

        path = context.locate(perform_substitutions(context, self.param_file))
        known = context.rewritten.get(str(path))
        if known is None and not self._substitutes(context):
            return path
        if known is None:
            known = ParameterText(path, read_file(path))
        if self._substitutes(context):
            try:
                known = ParameterText(known.file, perform(context, parse_substitution(known.text)))
            except InputError as error:
                raise InputError(error.message, file=known.file, valid=error.valid, value=error.value) from None
        return known

    def _substitutes(self, context: LaunchContext) -> bool:
        if isinstance(self.allow_substs, bool):
            return self.allow_substs
        return bool(_as_type(perform(context, self.allow_substs), bool))


def read_file(path: Path) -> str:
    """A parameter file's text.

    Raises:
        InputError: it cannot be read.
    """
    absent = absent_package_in(str(path))
    if absent is not None:
        raise AbsentError(f"package {absent!r} is absent, and a file of it is read: {path}")
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"the parameter file cannot be read ({error})", file=path) from None


def write_rewritten(context: LaunchContext, content: ParameterText) -> Path:
    """Writes a rewritten file and remembers what it is."""
    path = lasting_folder(content.text) / content.file.name
    part = path.with_name(f"{path.name}.{os.getpid()}")
    part.write_text(content.text, encoding="utf-8")
    part.replace(path)  # whole or not at all, for other processes
    context.rewritten[str(path)] = content
    return path


def evaluate_parameters(
    context: LaunchContext, parameters: Any
) -> Iterator[Path | ParameterText | Mapping[str, Value]]:
    """A node's ``parameters=``, each entry in turn.

    Raises:
        InputError: an entry is not a file, a mapping or a parameter.
    """
    if parameters is None:
        return
    if isinstance(parameters, str | Mapping) or not isinstance(parameters, Iterable):
        raise InputError(f"parameters is a list of files and mappings, and this is a {type(parameters).__name__}")
    for entry in parameters:
        if isinstance(entry, Mapping):
            yield evaluate_parameter_dict(context, entry)
        elif isinstance(entry, Parameter):
            name, value = entry.evaluate_pair(context)
            yield {name: value}
        elif isinstance(entry, ParameterFile):
            yield entry.read(context)
        elif isinstance(entry, str | bytes | os.PathLike | Substitution) or _is_text(entry):
            yield ParameterFile(entry).read(context)
        else:
            raise InputError(f"parameters holds files and mappings, and {entry!r} is of type {type(entry).__name__}")


def evaluate_parameter_dict(
    context: LaunchContext, parameters: Mapping[Any, Any], prefix: str = ""
) -> dict[str, Value]:
    """A mapping of parameters; nested names are joined with a dot."""
    values: dict[str, Value] = {}
    for key, value in parameters.items():
        name = prefix + perform(context, key)
        if isinstance(value, Mapping):
            values.update(evaluate_parameter_dict(context, value, f"{name}."))
        elif isinstance(value, ParameterValue):
            values[name] = _with_name(name, value.evaluate, context)
        else:
            values[name] = typed_value(context, value, f"parameter {name!r}")
    return values


def typed_value(context: LaunchContext, value: Any, what: str) -> Value:
    """A value by ROS's rules: numbers and text as they are, what a substitution gives as YAML takes it.

    Text that is no YAML value (a URDF with a colon in a comment, say) stays text, with a warning, where ROS refuses it.

    Raises:
        InputError: a value of a type that a parameter cannot have.
    """
    if isinstance(value, bool | int | float | str | bytes):
        return value
    if isinstance(value, Substitution):
        return _yaml_value(context, perform(context, value), what)
    if isinstance(value, os.PathLike):
        return str(value)
    if isinstance(value, Sequence):
        return _sequence_value(context, value, what)
    if hasattr(value, "item"):  # a NumPy number
        return typed_value(context, value.item(), what)
    raise InputError(f"{what} is {value!r}, of type {type(value).__name__}, which no parameter can have")


def _sequence_value(context: LaunchContext, values: Sequence[Any], what: str) -> Value:
    if not values:
        return ()
    if any(isinstance(value, Substitution) for value in values) and _is_text(values):
        return _yaml_value(context, perform(context, values), what)  # the parts of one text
    kinds = {type(value) for value in values}
    if kinds <= {bool, int, float}:
        return _uniform(list(values))
    items = [
        _yaml_scalar(perform(context, value)) if isinstance(value, Sequence) and not isinstance(value, str) else value
        for value in values
    ]
    return _uniform(items)


def _uniform(values: Sequence[Any]) -> Value:
    kinds = {type(value) for value in values}
    if len(kinds) == 1 and kinds <= {bool, int, float, str}:
        return tuple(values)
    if kinds <= {int, float}:
        return tuple(float(value) for value in values)
    return tuple(str(value) for value in values)


def _yaml_value(context: LaunchContext, text: str, what: str) -> Value:
    if not text:
        return ""
    if text.lstrip().startswith("<"):  # a robot description
        return _description(context, text, what)
    try:
        value = load_yaml(text)
    except yaml.YAMLError:
        context.log.append(
            f"{what} is text that is no YAML, which ROS refuses without ParameterValue(…, value_type=str)"
        )
        return text
    if isinstance(value, _SCALARS):
        return value
    if isinstance(value, list) and value and all(isinstance(item, _SCALARS) for item in value):
        return _uniform(value)
    return text


def _description(context: LaunchContext, text: str, what: str) -> str:
    try:
        plain = isinstance(load_yaml(text), str)
    except yaml.YAMLError:
        plain = False
    if not plain:
        context.log.append(
            f"{what} is XML that YAML misreads, which ROS refuses without ParameterValue(…, value_type=str)"
        )
    return text


def _yaml_scalar(text: str) -> Any:
    try:
        value = load_yaml(text)
    except yaml.YAMLError:
        return text
    return value if isinstance(value, _SCALARS) else text


def _as_type(value: Any, kind: Any) -> Value:
    """Text (or a number) as a type that a ParameterValue asks for."""
    if typing.get_origin(kind) is not None and isinstance(value, str):
        items = load_yaml(value)
        if not isinstance(items, list):
            raise InputError(f"{value!r} is not a list, which the parameter's type asks for")
        return _items_as(items, kind)
    return _scalar_as(value, kind)


def _items_as(items: Iterable[Any], kind: Any) -> tuple[Scalar, ...]:
    arguments = typing.get_args(kind)
    return tuple(_scalar_as(item, arguments[0] if arguments else str) for item in items)


def _scalar_as(value: Any, kind: Any) -> Scalar:
    if kind is str:
        return str(value)
    plain = load_yaml(value) if isinstance(value, str) else value
    if kind is bool and isinstance(plain, bool):
        return plain
    if kind is int and isinstance(plain, int) and not isinstance(plain, bool):
        return plain
    if kind is float and isinstance(plain, int | float) and not isinstance(plain, bool):
        return float(plain)
    if kind is float and isinstance(plain, str):
        try:
            return float(plain)  # YAML 1.1 takes 1e-3 for text
        except ValueError:
            pass
    name = getattr(kind, "__name__", str(kind))
    raise InputError(f"{value!r} is not of the parameter's type, {name}")


def _with_name(name: str, evaluate: Any, context: LaunchContext) -> Value:
    try:
        value: Value = evaluate(context)
    except AbsentError:
        raise
    except InputError as error:
        if error.file is not None:
            raise
        raise InputError(f"parameter {name!r}: {error.message}", valid=error.valid, value=error.value) from None
    return value


def _is_text(value: Any) -> bool:
    """Whether a list is the parts of one text: strings, paths and substitutions."""
    return isinstance(value, list | tuple) and all(isinstance(part, str | os.PathLike | Substitution) for part in value)
