"""A scenario as YAML, and back: each value knows its line."""

import dataclasses
from collections.abc import Mapping
from enum import Enum
from functools import cached_property
from pathlib import Path
from typing import Any

import yaml

from drake_twin.description.source_file import check_regular, file_text
from drake_twin.description.yaml_document import YamlDocument
from drake_twin.errors import InputError
from drake_twin.scenario import Scenario, ScenarioError
from drake_twin.scenario.absolute_files import with_absolute_files
from drake_twin.typed_data import Reader, ValuePath
from drake_twin.versions import SCENARIO


def scenario_to_yaml(scenario: Scenario) -> str:
    """Write a scenario as YAML that `ScenarioFile` reads back to an equal scenario; defaults are left out."""
    plain = {"version": SCENARIO.version, **_as_plain(scenario)}
    return yaml.dump(plain, Dumper=_Dumper, sort_keys=False, width=120, allow_unicode=True)


class ScenarioFile:
    """A scenario's YAML file, with the line of each value.

    Args:
        text: The YAML text.
        file: Its file; relative file names in the text are relative to it.

    Attributes:
        as_written: The scenario, with the names of files as they stand there.

    Raises:
        InputError: If a value cannot be used; with its file and line, and what would be valid.
    """

    def __init__(self, text: str, file: str | Path):
        self._document = YamlDocument(text, file)
        data = self._document.data
        if isinstance(data, dict) and "version" in data:
            try:
                SCENARIO.check(data.pop("version"), file)
            except InputError as error:
                raise self._document.error(("version",), error.message) from None
        try:
            self.as_written: Scenario = _Reader(self._document.error).read(Scenario, data)
        except ScenarioError as error:
            raise self.located(error) from None

    @cached_property
    def scenario(self) -> Scenario:
        """The scenario, with the files that it names relative to its own file's folder."""
        return with_absolute_files(self.as_written, self._document.file.absolute().parent)

    @classmethod
    def read(cls, file: str | Path) -> "ScenarioFile":
        """Read a file.

        Raises:
            InputError: If the file cannot be read, or a value in it cannot be used.
        """
        try:
            check_regular(Path(file))
            return cls(file_text(file), file)
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


class _Reader(Reader):
    texts_of_numbers = True  # xacro arguments are text, also where YAML reads a number

    def read_class(self, kind: type, value: Any, path: ValuePath) -> Any:
        if value is None and not path:
            raise self.error(path, "the file is empty: a scenario is needed")
        return super().read_class(kind, value, path)
