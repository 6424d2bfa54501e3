"""Parameter files rewritten on the way (``nav2_common.launch``)."""

from __future__ import annotations

import sys
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import yaml

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.errors import InputError
from drake_twin.ros2.launched import ParameterText
from drake_twin.ros2.parameters import read_file, write_rewritten
from drake_twin.ros2.substitution import (
    SomeSubstitutionsType,
    Substitution,
    normalize_to_list_of_substitutions,
    perform,
    perform_substitutions,
)

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext


# Aliases let a few lines stand for gigabytes.
_MOST_VALUES = 200_000


class _RewrittenFile(Substitution, ABC):
    def __init__(self, source_file: SomeSubstitutionsType):
        self.source_file = normalize_to_list_of_substitutions(source_file)

    def perform(self, context: LaunchContext) -> str:
        """The path of the rewritten file."""
        path = context.locate(perform_substitutions(context, self.source_file))
        known = context.rewritten.get(str(path))
        source = known or ParameterText(path, read_file(path))
        return str(write_rewritten(context, ParameterText(source.file, self._rewrite(source, context))))

    @abstractmethod
    def _rewrite(self, source: ParameterText, context: LaunchContext) -> str:
        """The text that takes the place of the file's."""


class RewrittenYaml(_RewrittenFile):
    """A parameter file with other values or keys.

    Args:
        source_file: the file.
        param_rewrites: parameter name, or path such as ``node.ros__parameters.x``, to new value.
        root_key: a key to put everything under, a namespace for instance.
        key_rewrites: key to new key.
        convert_types: whether a new value is read as a number or truth value.
        value_rewrites: value to new value, for values that stand anywhere.
    """

    def __init__(
        self,
        source_file: SomeSubstitutionsType,
        param_rewrites: Mapping[str, Any] | None = None,
        root_key: SomeSubstitutionsType | None = None,
        key_rewrites: Mapping[str, Any] | None = None,
        convert_types: bool = False,
        value_rewrites: Mapping[str, Any] | None = None,
    ):
        super().__init__(source_file)
        self.param_rewrites = dict(param_rewrites or {})
        self.root_key = root_key
        self.key_rewrites = dict(key_rewrites or {})
        self.convert_types = convert_types
        self.value_rewrites = dict(value_rewrites or {})

    def _rewrite(self, source: ParameterText, context: LaunchContext) -> str:
        data = _read_yaml(source)
        values = {name: self._converted(perform(context, value)) for name, value in self.param_rewrites.items()}
        keys = {name: perform(context, value) for name, value in self.key_rewrites.items()}
        others = {name: self._converted(perform(context, value)) for name, value in self.value_rewrites.items()}
        data = _rewritten(data, "", values, keys, others)
        root = "" if self.root_key is None else perform(context, self.root_key)
        if root:
            data = {root: data}
        return yaml.safe_dump(data, sort_keys=False)

    def _converted(self, text: str) -> Any:
        if not self.convert_types:
            return {"true": True, "false": False}.get(text.lower(), text)
        value = load_yaml(text) if text else text
        return value if isinstance(value, bool | int | float) else text


def _read_yaml(source: ParameterText) -> Any:
    """The file's data; of a key that stands twice the last counts, as for Nav2."""
    try:
        data = load_yaml(source.text)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        raise InputError(
            f"this is not valid YAML: {getattr(error, 'problem', error)}",
            file=source.file,
            line=None if mark is None else mark.line + 1,
        ) from None
    if _count(data) > _MOST_VALUES:
        raise InputError(f"the file holds more than {_MOST_VALUES} values", file=source.file)
    return data


def _count(data: Any, counted: int = 0) -> int:
    """How many values the data has once its aliases are written out; stops counting above the bound."""
    children = data.values() if isinstance(data, dict) else data if isinstance(data, list) else ()
    for child in children:
        counted = _count(child, counted + 1)
        if counted > _MOST_VALUES:
            break
    return counted


def _rewritten(
    data: Any, path: str, values: Mapping[str, Any], keys: Mapping[str, str], others: Mapping[str, Any]
) -> Any:
    if isinstance(data, list):
        return [_rewritten(item, f"{path}[{index}]", {}, keys, others) for index, item in enumerate(data)]
    if not isinstance(data, dict):
        return others.get(data, data) if isinstance(data, str) else data
    result: dict[Any, Any] = {}
    for key, value in data.items():
        full = f"{path}.{key}" if path else str(key)
        new_key = keys.get(key, key)
        if full in values or (key in values and not isinstance(value, dict)):
            result[new_key] = values.get(full, values.get(key))
        else:
            result[new_key] = _rewritten(value, full, values, keys, others)
    for name, value in values.items():  # a path that names an entry of this mapping which is not there yet
        before, _, last = name.rpartition(".")
        if path and before == path and last not in result:
            result[last] = value
    return result


class ReplaceString(_RewrittenFile):
    """A file with texts replaced.

    Args:
        source_file: the file.
        replacements: text to new text.
        condition: where it does not hold, the file stays as it is.
    """

    def __init__(self, source_file: SomeSubstitutionsType, replacements: Mapping[str, Any], condition: Any = None):
        super().__init__(source_file)
        self.replacements = dict(replacements)
        self._condition = condition

    @property
    def condition(self) -> Any:
        """The condition, or None."""
        return self._condition

    def perform(self, context: LaunchContext) -> str:
        """The path of the rewritten file."""
        if self._condition is not None and not self._condition.evaluate(context):
            return perform_substitutions(context, self.source_file)
        return super().perform(context)

    def _rewrite(self, source: ParameterText, context: LaunchContext) -> str:
        text = source.text
        for old, new in self.replacements.items():
            text = text.replace(old, perform(context, new))
        return text


class HasNodeParams(Substitution):
    """``True`` if a parameter file has an entry for a node."""

    def __init__(self, source_file: SomeSubstitutionsType, node_name: str):
        self.source_file = normalize_to_list_of_substitutions(source_file)
        self.node_name = node_name

    def perform(self, context: LaunchContext) -> str:
        """``True`` or ``False``."""
        path = context.locate(perform_substitutions(context, self.source_file))
        known = context.rewritten.get(str(path))
        data = load_yaml(read_file(path) if known is None else known.text)
        return str(isinstance(data, dict) and self.node_name in data)


class LaunchConfigAsBool(Substitution):
    """A launch configuration as ``True`` or ``False``."""

    def __init__(self, name: str):
        self.name = name

    def perform(self, context: LaunchContext) -> str:
        """``True`` or ``False``."""
        return str(str(context.launch_configurations.get(self.name, "")).lower() in ("true", "1", "yes", "on"))


class ParseMultiRobotPose:
    """Poses of robots from a command-line argument: ``robots:="r1={x: 1.0, y: 2.0}; r2={x: 3.0}"``."""

    def __init__(self, target_argument: str):
        prefix = f"{target_argument}:="
        self._text = next((word[len(prefix) :] for word in sys.argv if word.startswith(prefix)), "")

    def value(self) -> dict[str, dict[str, float]]:
        """Robot → x, y, z, roll, pitch, yaw (m, rad)."""
        robots: dict[str, dict[str, float]] = {}
        for part in self._text.split(";"):
            name, equals, pose = part.partition("=")
            if equals:
                given = load_yaml(pose)
                if not isinstance(given, dict):
                    raise InputError(f"{part.strip()!r} is not a robot's name and pose such as r1={{x: 1.0, y: 2.0}}")
                known = {"x": 0.0, "y": 0.0, "z": 0.0, "roll": 0.0, "pitch": 0.0, "yaw": 0.0}
                robots[name.strip()] = known | {key: float(value) for key, value in given.items()}
        return robots
