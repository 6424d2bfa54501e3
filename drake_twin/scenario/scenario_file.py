"""A scenario as YAML, and back: each value knows its line."""

import dataclasses
import types
import typing
from collections.abc import Mapping
from enum import Enum
from math import isfinite
from pathlib import Path
from typing import Any

import yaml

from drake_twin.description.source_file import check_regular
from drake_twin.description.yaml_document import ValuePath, YamlDocument
from drake_twin.errors import InputError
from drake_twin.scenario import Scenario, ScenarioError
from drake_twin.scenario.absolute_files import with_absolute_files
from drake_twin.scenario.typed_values import field_types
from drake_twin.values import yaml_number


def scenario_to_yaml(scenario: Scenario) -> str:
    """Write a scenario as YAML that `ScenarioFile` reads back to an equal scenario; defaults are left out."""
    return yaml.dump(_as_plain(scenario), Dumper=_Dumper, sort_keys=False, width=120, allow_unicode=True)


class ScenarioFile:
    """A scenario's YAML file, with the line of each value.

    Args:
        text: The YAML text.
        file: Its file; relative file names in the text are relative to it.

    Attributes:
        scenario: The scenario.

    Raises:
        InputError: If a value cannot be used; with its file and line, and what would be valid.
    """

    def __init__(self, text: str, file: str | Path):
        self._document = YamlDocument(text, file)
        try:
            scenario: Scenario = _read(Scenario, self._document.data, self._document, ())
        except ScenarioError as error:
            raise self.located(error) from None
        self.scenario = with_absolute_files(scenario, Path(file).absolute().parent)

    @classmethod
    def read(cls, file: str | Path) -> "ScenarioFile":
        """Read a file.

        Raises:
            InputError: If the file cannot be read, or a value in it cannot be used.
        """
        try:
            check_regular(Path(file))
            return cls(Path(file).read_text(encoding="utf-8"), file)
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"the scenario cannot be read ({error})", file=file) from None

    def located(self, error: ScenarioError) -> InputError:
        """Return an error of building this scenario with the file and line of the value at fault."""
        return self._document.error(error.path, error.reason, **error.more)


class _Dumper(yaml.SafeDumper):
    """Writes short lists on one line, and indents lists in mappings."""

    def increase_indent(self, flow: bool = False, indentless: bool = False) -> None:
        super().increase_indent(flow, False)


def _represent_list(dumper: yaml.SafeDumper, values: list[Any]) -> yaml.Node:
    flat = all(isinstance(value, int | float | str) for value in values)
    return dumper.represent_sequence("tag:yaml.org,2002:seq", values, flow_style=flat)


_Dumper.add_representer(list, _represent_list)


def _as_plain(value: Any) -> Any:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {
            item.name: _as_plain(getattr(value, item.name))
            for item in dataclasses.fields(value)
            if getattr(value, item.name) != _default(item)
        }
    if isinstance(value, Mapping):
        return {key: _as_plain(item) for key, item in value.items()}
    if isinstance(value, tuple):
        return [_as_plain(item) for item in value]
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, float | int) and not isinstance(value, bool):
        return float(value) if isinstance(value, float) else int(value)  # NumPy's, too
    return value


def _default(item: "dataclasses.Field[Any]") -> Any:
    return item.default if item.default_factory is dataclasses.MISSING else item.default_factory()


def _read(kind: Any, value: Any, document: YamlDocument, path: ValuePath) -> Any:
    """Convert plain data to the annotated type; errors name the value by its line and path."""
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if dataclasses.is_dataclass(kind):
        return _read_dataclass(typing.cast(type, kind), value, document, path)
    if origin is types.UnionType:
        if value is None and type(None) in arguments:
            return None
        if isinstance(value, dict) and Mapping[str, Any] in arguments:
            return value
        return _read(next(item for item in arguments if item is not type(None)), value, document, path)
    if origin is tuple:
        if not isinstance(value, list):
            raise document.error(path, f"{value!r} is not a list")
        if arguments[-1] is Ellipsis:
            return tuple(_read(arguments[0], item, document, (*path, index)) for index, item in enumerate(value))
        if len(value) != len(arguments):
            raise document.error(path, f"{value!r} has {len(value)} elements, but {len(arguments)} are needed")
        return tuple(_read(float, item, document, (*path, index)) for index, item in enumerate(value))
    if origin is Mapping:
        if not isinstance(value, dict):
            raise document.error(path, f"{value!r} is not a mapping")
        return {str(key): _read(arguments[1], item, document, (*path, key)) for key, item in value.items()}
    return _read_scalar(kind, value, document, path)


def _read_scalar(kind: type, value: Any, document: YamlDocument, path: ValuePath) -> Any:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if kind is float:
        number = yaml_number(value)
        if number is None or not isfinite(number):
            shown = repr(value) if len(repr(value)) <= 80 else repr(value)[:80] + "…"
            raise document.error(path, f"{shown} is not a finite number")
        return number
    if issubclass(kind, Enum):
        valid = [item.value for item in kind]
        if value not in valid:
            raise document.error(path, f"unknown value {value!r}", value=str(value), valid=valid)
        return kind(value)
    if kind is int and (not is_number or value != int(value)):
        raise document.error(path, f"{value!r} is not a whole number")
    if kind is bool and not isinstance(value, bool):
        raise document.error(path, f"{value!r} is neither true nor false")
    if kind is str:
        if isinstance(value, bool) or is_number:  # xacro arguments are text, also where YAML reads a number
            return str(value).lower() if isinstance(value, bool) else str(value)
        if not isinstance(value, str):
            raise document.error(path, f"{value!r} is not text")
    return value


def _read_dataclass(kind: type, value: Any, document: YamlDocument, path: ValuePath) -> Any:
    if value is None and not path:
        raise document.error(path, "the file is empty: a scenario is needed")
    if not isinstance(value, dict):
        raise document.error(path, f"{value!r} is not a mapping")
    kinds = field_types(kind)
    for key in value:
        if key not in kinds:
            raise document.error((*path, key), "unknown entry", value=str(key), valid=list(kinds))
    for item in dataclasses.fields(kind):
        required = item.default is dataclasses.MISSING and item.default_factory is dataclasses.MISSING
        if required and item.name not in value:
            raise document.error(path, f"the entry {item.name!r} is missing")
    return kind(**{key: _read(kinds[key], item, document, (*path, key)) for key, item in value.items()})
