"""XML launch files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from lxml import etree

from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Place
from drake_twin.ros2.entity import LaunchDescription
from drake_twin.ros2.frontend import Element, FrontEnd, read_launch_file

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext


def load_xml_file(path: str, context: LaunchContext) -> LaunchDescription:
    """The launch description of an XML launch file.

    Raises:
        InputError: it cannot be read, or holds something that is not known.
    """
    reader = XmlReader(read_launch_file(path), Path(path))
    return FrontEnd().description(_element(reader.root, path))


def _element(node: etree._Element, path: str) -> Element:
    line: object = node.sourceline  # the stubs' type is not a number's
    return Element(
        tag=etree.QName(node).localname,
        place=Place(path, line if isinstance(line, int) and line else None),
        attributes={str(name): str(value) for name, value in node.attrib.items() if not str(name).startswith("{")},
        children=tuple(_element(child, path) for child in node if isinstance(child.tag, str)),
    )
