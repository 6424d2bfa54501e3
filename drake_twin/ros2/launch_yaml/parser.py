"""YAML launch files."""

from typing import Any

from drake_twin.description.yaml_document import YamlDocument
from drake_twin.findings import Place
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.launch_description import LaunchDescription
from drake_twin.ros2.launch.launch_description_sources.frontend_launch_file_utilities import (
    parse_description,
    read_launch_file,
)
from drake_twin.typed_data import ValuePath

__all__: list[str] = []  # launch files find nothing of ROS's here

_CHILDREN = "children"


def load_yaml_file(path: str) -> LaunchDescription:
    """Return the launch description of a YAML launch file.

    Raises:
        InputError: If it cannot be read, or an element or attribute is unknown, missing or wrong.
    """
    document = YamlDocument(read_launch_file(path), path)
    if not isinstance(document.data, dict) or "launch" not in document.data:
        raise document.error((), "a YAML launch file has one entry, launch, with the list of actions")
    return parse_description(_entity(document, "launch", document.data["launch"], ("launch",)))


def _entity(document: YamlDocument, tag: str, body: Any, path: ValuePath, line: int | None = None) -> Entity:
    """Return ``tag: body`` as an element; lists of mappings in the body are its children."""
    place = Place(str(document.file), line or document.line(path))
    if body is None:
        return _refused(Entity(tag, place, typed=True), "it is empty, where YAML wants {}")
    if isinstance(body, list):
        return Entity(tag, place, children=_actions(document, body, path), typed=True)
    if not isinstance(body, dict):
        raise document.error(path, f"{body!r} is not a mapping")
    attributes: dict[str, Any] = {}
    children: list[Entity] = []
    for key, value in body.items():
        below = (*path, key)
        if key == _CHILDREN:
            if not isinstance(value, list):
                raise document.error(below, f"{value!r} is not a list of actions")
            children += _actions(document, value, below)
        elif isinstance(value, dict):
            child = _entity(document, str(key), value, below)
            children.append(_refused(child, "one mapping, where ROS wants a list of mappings"))
        elif isinstance(value, list) and value and all(isinstance(item, dict) for item in value):
            children += [_entity(document, str(key), item, (*below, index)) for index, item in enumerate(value)]
        else:
            attributes[str(key)] = value
    return Entity(tag, place, attributes, children, typed=True)


def _refused(entity: Entity, what: str) -> Entity:
    entity.refused_by_ros(what)
    return entity


def _actions(document: YamlDocument, items: list[Any], path: ValuePath) -> list[Entity]:
    elements = []
    for index, item in enumerate(items):
        below = (*path, index)
        if not isinstance(item, dict) or len(item) != 1:
            raise document.error(below, "an action is a mapping with one entry, such as node: {pkg: …, exec: …}")
        ((tag, body),) = item.items()
        elements.append(_entity(document, str(tag), body, (*below, tag), document.line(below)))
    return elements
