"""The elements of XML and YAML launch files (``launch.frontend.entity``)."""

from __future__ import annotations

import typing
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import yaml

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.errors import InputError
from drake_twin.findings import Place

_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


class MissingAttributeError(InputError):
    """Raised for an attribute that an element needs and does not have.

    Args:
        entity: The element.
        name: The attribute.
    """

    def __init__(self, entity: Entity, name: str):
        super().__init__(
            f"<{entity.type_name}>: the attribute {name!r} is missing", file=entity.place.file, line=entity.place.line
        )
        self.entity = entity


class Entity:
    """An element of a launch file, in XML or YAML.

    ``-`` and ``_`` are the same in the names of attributes.

    Args:
        type_name: Its tag.
        place: Where it stands.
        attributes: Name → text, number, truth value, or a list of them (YAML only).
        children: The elements in it.

    Attributes:
        parent: The element that it stands in; None for the outermost.
    """

    def __init__(
        self,
        type_name: str,
        place: Place,
        attributes: Mapping[str, Any] | None = None,
        children: Sequence[Entity] = (),
    ):
        self.type_name = type_name
        self.place = place
        self.parent: Entity | None = None
        self.children = list(children)
        self._attributes = {_spelled(name): value for name, value in (attributes or {}).items()}
        self._names = {_spelled(name): name for name in attributes or {}}
        self._known: dict[str, None] = {}
        self._known_children: set[str] = set()
        self._closed = False
        self._searched = False
        for child in self.children:
            child.parent = self

    def __contains__(self, name: str) -> bool:
        return _spelled(name) in self._attributes

    def get_attr(self, name: str, *, data_type: Any = str, optional: bool = False, can_be_str: bool = True) -> Any:
        """Return an attribute.

        Args:
            name: Its name.
            data_type: ``str``, ``bool``, ``int``, ``float``, a list of one of them, None for what YAML takes the text
                for, or ``list[Entity]`` for the children with this tag.
            optional: Whether None is returned for a missing attribute.
            can_be_str: Whether text that is not of the type, such as a substitution, is returned as it is.

        Raises:
            InputError: If the attribute is missing, or not of the type.
        """
        if _item_type(data_type) is Entity:
            children = self.children_named(name)
            if not children and not optional:
                raise MissingAttributeError(self, name)
            return children or None
        value = self.raw(name)
        if value is None:
            if optional:
                return None
            if self._searched:
                return ""
            raise MissingAttributeError(self, name)
        separator = self.raw(f"{name}-sep") if _item_type(data_type) is not None and isinstance(value, str) else None
        if separator is not None:
            value = value.split(str(separator))
        try:
            return _typed(value, data_type)
        except (ValueError, TypeError, KeyError, yaml.YAMLError):
            if can_be_str and isinstance(value, str):
                return value
        if data_type is bool:
            raise self.error(f"{name} is {value!r}, which is neither true nor false", valid=["true", "false"])
        raise self.error(f"{name} is {value!r}, which is not of type {getattr(data_type, '__name__', data_type)}")

    def raw(self, name: str) -> Any:
        """Return an attribute as the file has it: text in XML, any YAML scalar or list in YAML; None if missing."""
        self._known[name] = None
        return self._attributes.get(_spelled(name))

    def children_named(self, name: str) -> list[Entity]:
        """Return the children with a tag."""
        self._known_children.add(name)
        return [child for child in self.children if child.type_name == name]

    def close(self) -> None:
        """Refuse, in `assert_entity_completely_parsed`, children with tags that were not asked for."""
        self._closed = True

    def refuse_unknown(self, parse: Callable[[Entity], object]) -> None:
        """Check that a parse method which failed for a missing attribute knows all those that the element has.

        Raises:
            InputError: If it does not: the missing one may be misspelled.
        """
        self._searched = True  # parse to the end, to learn what the method asks for
        try:
            parse(self)
        except Exception:  # another attribute is wrong, too
            return
        self.assert_entity_completely_parsed()

    def assert_entity_completely_parsed(self) -> None:
        """Check that all attributes have been asked for.

        Raises:
            InputError: If some have not.
        """
        for child in self.children if self._closed else ():
            if child.type_name not in self._known_children:
                raise child.error(
                    f"not an element of <{self.type_name}>", value=child.type_name, valid=sorted(self._known_children)
                )
        known = {_spelled(name) for name in self._known}
        for name in self._attributes:
            if name not in known:
                written = self._names[name]
                raise self.error(f"unknown attribute {written!r}", value=written, valid=sorted(self._known))

    def error(self, message: str, **more: Any) -> InputError:
        """Return an error that points at the element."""
        return InputError(f"<{self.type_name}>: {message}", file=self.place.file, line=self.place.line, **more)


def _spelled(name: str) -> str:
    return name.replace("-", "_")


def _item_type(data_type: Any) -> Any:
    """Return ``x`` of ``list[x]``; None for another type."""
    return typing.get_args(data_type)[0] if typing.get_origin(data_type) is list else None


def _typed(value: Any, data_type: Any) -> Any:
    if _item_type(data_type) is not None:
        items = load_yaml(value) if isinstance(value, str) else value
        if not isinstance(items, list):
            raise TypeError
        return [_typed(item, _item_type(data_type)) for item in items]
    if data_type is None:
        return load_yaml(value) if isinstance(value, str) else value
    if data_type is str:
        return attribute_text(value)
    if data_type is bool:
        return value if isinstance(value, bool) else _BOOLEANS[attribute_text(value).strip().lower()]
    return data_type(value)


def attribute_text(value: Any) -> str:
    """Return an attribute as text, as XML would have it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return str(value)
