"""XML launch files."""

from pathlib import Path

from lxml import etree

from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Place
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.launch_description import LaunchDescription
from drake_twin.ros2.launch.launch_description_sources.frontend_launch_file_utilities import (
    parse_description,
    read_launch_file,
)

__all__: list[str] = []  # launch files find nothing of ROS's here


def load_xml_file(path: str) -> LaunchDescription:
    """Return the launch description of an XML launch file.

    Raises:
        InputError: If it cannot be read, or an element or attribute is unknown, missing or wrong.
    """
    reader = XmlReader(read_launch_file(path), Path(path))
    return parse_description(_entity(reader.root, path))


def _entity(node: etree._Element, path: str) -> Entity:
    line: object = node.sourceline  # the stubs' type is not a number's
    return Entity(
        etree.QName(node).localname,
        Place(path, line if isinstance(line, int) and line else None),
        {str(name): str(value) for name, value in node.attrib.items() if not str(name).startswith("{")},
        [_entity(child, path) for child in node if isinstance(child.tag, str)],
    )
