"""A parameter file with other values or keys."""

from collections.abc import Mapping
from typing import Any

import yaml

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.errors import InputError
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launched import ParameterText
from drake_twin.ros2.rewritten_files import RewrittenFile

# Aliases let a few lines stand for gigabytes.
_MOST_VALUES = 200_000


class RewrittenYaml(RewrittenFile):
    """A parameter file with other values or keys.

    Args:
        source_file: The file.
        param_rewrites: Parameter name, or path such as ``node.ros__parameters.x``, to new value.
        root_key: A key to put everything under, a namespace for instance.
        key_rewrites: Key to new key.
        convert_types: Whether a new value is read as a number or truth value.
        value_rewrites: Value to new value, for values anywhere in the file.
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

    def rewrite(self, source: ParameterText, context: LaunchContext) -> str:
        """Return the rewritten YAML.

        Raises:
            InputError: If the file is not valid YAML, or holds too many values.
        """
        data = _read_yaml(source)
        values = {
            name: self._converted(context.perform_substitution(value)) for name, value in self.param_rewrites.items()
        }
        keys = {name: context.perform_substitution(value) for name, value in self.key_rewrites.items()}
        others = {
            name: self._converted(context.perform_substitution(value)) for name, value in self.value_rewrites.items()
        }
        data = _rewritten(data, "", values, keys, others)
        root = "" if self.root_key is None else context.perform_substitution(self.root_key)
        if root:
            data = {root: data}
        return yaml.safe_dump(data, sort_keys=False)

    def _converted(self, text: str) -> Any:
        if not self.convert_types:
            return {"true": True, "false": False}.get(text.lower(), text)
        value = load_yaml(text) if text else text
        return value if isinstance(value, bool | int | float) else text


def _read_yaml(source: ParameterText) -> Any:
    """Return the file's data; of a duplicate key the last counts, as for Nav2."""
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
    """Count the data's values with its aliases written out; stop counting above the bound."""
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
    for name, value in values.items():  # the path of a new entry of this mapping
        before, _, last = name.rpartition(".")
        if path and before == path and last not in result:
            result[last] = value
    return result
