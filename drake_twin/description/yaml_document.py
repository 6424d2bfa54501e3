"""YAML files as plain data, with the line of each value."""

from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

import yaml

from drake_twin.description.bounded_yaml import DEEPEST, compose_yaml
from drake_twin.errors import InputError
from drake_twin.typed_data import ValuePath

# Aliases let a few lines expand to gigabytes; scenarios and parameters files have far fewer values than this.
_MOST_VALUES = 200_000

_MERGE_TAG = "tag:yaml.org,2002:merge"


class YamlDocument:
    """A YAML file's data, with the line of every value.

    Args:
        text: The file's text.
        file: Its name, for error messages.
        like_rcl: Whether a key may occur twice, as in ROS's parameters files: mappings are merged, and any other later
            value replaces the earlier one.

    Attributes:
        data: Mappings as ``dict``, sequences as ``list``, scalars by YAML 1.1 as in PyYAML's safe loader.

    Raises:
        InputError: If the text is not YAML, a key occurs twice in one mapping, or aliases make it too large for memory.
    """

    def __init__(self, text: str, file: str | Path, *, like_rcl: bool = False):
        self.file = Path(file)
        self._like_rcl = like_rcl
        self._lines: dict[ValuePath, int] = {}
        self._constructor = yaml.constructor.SafeConstructor()
        self._items_of_mapping: dict[yaml.Node, dict[Any, yaml.Node]] = {}
        try:
            root = compose_yaml(text)
        except yaml.YAMLError as error:
            mark = getattr(error, "problem_mark", None)
            problem = getattr(error, "problem", None) or str(error).splitlines()[0]
            raise InputError(
                f"this is not valid YAML: {problem}", file=file, line=None if mark is None else mark.line + 1
            ) from None
        self.data = None if root is None else self._plain(root, ())

    def line(self, path: ValuePath) -> int | None:
        """Return the line (from 1) of the value at a path of keys and indices, or of the closest value above it.

        A key may be several keys in one word, as ``gains.elbow.p`` in ROS's parameters files.
        """
        while path and _in_one_word(path) not in self._lines_by_word:
            path = path[:-1]
        return self._lines_by_word.get(_in_one_word(path))

    @property
    def paths(self) -> Iterator[ValuePath]:
        """The path of each value but the outermost, in file order."""
        return (path for path in self._lines if path)

    def has(self, path: ValuePath) -> bool:
        """Tell whether a value is at a path or below it."""
        word = _in_one_word(path)
        return any(known == word or known.startswith(f"{word}.") for known in self._lines_by_word)

    @cached_property
    def _lines_by_word(self) -> dict[str, int]:
        return {_in_one_word(path): line for path, line in self._lines.items()}

    def error(self, path: ValuePath, message: str, **more: Any) -> InputError:
        """Return an error that points at the value at ``path``."""
        where = ".".join(key if (key := str(item)).isprintable() else repr(key) for item in path)
        return InputError(f"{where}: {message}" if where else message, file=self.file, line=self.line(path), **more)

    def _plain(self, node: yaml.Node, path: ValuePath) -> Any:
        self._lines[path] = node.start_mark.line + 1
        if len(self._lines) > _MOST_VALUES:
            raise InputError(f"the file holds more than {_MOST_VALUES} values", file=self.file)
        if len(path) > DEEPEST:
            raise InputError(f"the values nest more than {DEEPEST} deep", file=self.file, line=self._lines[path])
        if isinstance(node, yaml.MappingNode):
            return {key: self._plain(value_node, (*path, key)) for key, value_node in self._items(node).items()}
        if isinstance(node, yaml.SequenceNode):
            return [self._plain(item, (*path, index)) for index, item in enumerate(node.value)]
        return self._scalar(node)

    def _items(self, node: yaml.MappingNode, depth: int = 0) -> dict[Any, yaml.Node]:
        """Return a mapping's keys and values, with those of ``<<: *base`` below its own.

        PyYAML's ``flatten_mapping`` repeats a base as often as it is named, so that merges of merges outgrow memory.
        """
        known = self._items_of_mapping.get(node)
        if known is not None:
            return known
        self._items_of_mapping[node] = {}  # for a mapping that merges itself
        own: dict[Any, yaml.Node] = {}
        merged: dict[Any, yaml.Node] = {}
        for key_node, value_node in node.value:
            if key_node.tag == _MERGE_TAG:
                for key, value in self._merged_items(value_node, depth + 1):
                    merged.setdefault(key, value)
                continue
            key = self._scalar(key_node)
            if key in own and self._like_rcl:
                value_node = _together(own[key], value_node)
            elif key in own:
                raise InputError(f"{key!r} occurs twice", file=self.file, line=key_node.start_mark.line + 1)
            own[key] = value_node
        self._items_of_mapping[node] = merged | own
        return self._items_of_mapping[node]

    def _merged_items(self, node: yaml.Node, depth: int) -> Iterator[tuple[Any, yaml.Node]]:
        if depth > DEEPEST:
            raise InputError(f"<< nests more than {DEEPEST} deep", file=self.file, line=node.start_mark.line + 1)
        for base in node.value if isinstance(node, yaml.SequenceNode) else [node]:
            if not isinstance(base, yaml.MappingNode):
                raise InputError("<< takes a mapping or a list of them", file=self.file, line=base.start_mark.line + 1)
            yield from self._items(base, depth).items()

    def _scalar(self, node: yaml.Node) -> Any:
        if not isinstance(node, yaml.ScalarNode):
            raise InputError("a mapping's key must be text", file=self.file, line=node.start_mark.line + 1)
        try:
            return self._constructor.construct_object(node)
        except (yaml.YAMLError, ValueError, LookupError, AttributeError):  # the last two: `!!bool x`, `!!timestamp x`
            raise InputError(f"{node.value!r} is not a value", file=self.file, line=node.start_mark.line + 1) from None


def _in_one_word(path: ValuePath) -> str:
    return ".".join(map(str, path))


def _together(earlier: yaml.Node, later: yaml.Node) -> yaml.Node:
    """Merge two mappings under one key; of other values return the later."""
    if isinstance(earlier, yaml.MappingNode) and isinstance(later, yaml.MappingNode):
        return yaml.MappingNode(later.tag, [*earlier.value, *later.value], earlier.start_mark, later.end_mark)
    return later
