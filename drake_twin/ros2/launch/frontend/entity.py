"""The elements of XML and YAML launch files (``launch.frontend.entity``)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.ros2.evaluation import current_context
from drake_twin.ros2.typed_text import Typed, is_of_type, item_type, type_name, typed_items, typed_text


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
        attributes: Name → text; with ``typed`` also a number, a truth value, or a list of them.
        children: The elements in it.
        typed: Whether the values have types of their own, as in YAML, and are not converted.

    Attributes:
        parent: The element that it stands in; None for the outermost.
    """

    def __init__(
        self,
        type_name: str,
        place: Place,
        attributes: Mapping[str, Any] | None = None,
        children: Sequence[Entity] = (),
        *,
        typed: bool = False,
    ):
        self.type_name = type_name
        self.place = place
        self.parent: Entity | None = None
        self._children = list(children)
        self._typed = typed
        self._attributes = {_spelled(name): value for name, value in (attributes or {}).items()}
        self._names = {_spelled(name): name for name in attributes or {}}
        self._known: dict[str, None] = {}
        self._known_children: set[str] = set()
        self._searched = False
        for child in self._children:
            child.parent = self

    @property
    def children(self) -> list[Entity]:
        """The elements in it; asking for them says that their tags are known."""
        self._known_children.update(child.type_name for child in self._children)
        return list(self._children)

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

        What ROS refuses and can only mean one thing is noted in the active context.

        Raises:
            InputError: If the attribute is missing, or not of the type.
        """
        if item_type(data_type) is Entity:
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
        try:
            typed = (
                self._of_yaml(value, data_type) if self._typed else self._of_text(name, value, data_type, can_be_str)
            )
        except InputError:
            if data_type is bool:
                raise self.error(
                    f"{name} is {value!r}, which is neither true nor false", valid=["true", "false"]
                ) from None
            raise self.error(f"{name} is {value!r}, which is not of type {type_name(data_type)}") from None
        if typed.refused:
            self.refused_by_ros(f"{name} is {typed.refused}")
        return typed.value

    def _of_text(self, name: str, text: str, data_type: Any, can_be_str: bool) -> Typed:
        if f"{name}-sep" not in self:
            return typed_text(text, data_type, can_be_str=can_be_str)
        separator = self.raw(f"{name}-sep")
        kind = item_type(data_type)
        items = [typed_text(item, kind, can_be_str=can_be_str) for item in text.split(str(separator))]
        return typed_items([item.value for item in items], kind)

    def _of_yaml(self, value: Any, data_type: Any) -> Typed:
        if is_of_type(value, data_type, can_be_str=True):
            return Typed(value)
        if isinstance(value, list) and data_type is not str:
            return typed_items(value, item_type(data_type))
        refused = f"{value!r}, and not of type {type_name(data_type)}"
        return Typed(typed_text(attribute_text(value), data_type).value, refused)

    def refused_by_ros(self, what: str) -> None:
        """Note something in the element that ROS 2 refuses and the twin reads, in the active context."""
        current_context().refused_by_ros(f"<{self.type_name}>: {what}", self.place)

    def get_flag(self, name: str) -> Any:
        """Return a truth value; None if it is missing. ROS takes any text but an empty one for true."""
        value = self.get_attr(name, data_type=bool, optional=True)
        if isinstance(value, str):
            current_context().log.append(f"{self.place}: {name} is the text {value!r}, which ROS takes for true")
            return bool(value)
        return value

    def raw(self, name: str) -> Any:
        """Return an attribute as the file has it: text in XML, any YAML scalar or list in YAML; None if missing."""
        self._known[name] = None
        return self._attributes.get(_spelled(name))

    def children_named(self, name: str) -> list[Entity]:
        """Return the children with a tag."""
        self._known_children.add(name)
        return [child for child in self._children if child.type_name == name]

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
        """Check that all attributes and children have been asked for.

        Raises:
            InputError: If some have not.
        """
        for child in self._children:
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


def attribute_text(value: Any) -> str:
    """Return an attribute as text, as XML would have it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return " ".join(map(attribute_text, value))
    return str(value)
