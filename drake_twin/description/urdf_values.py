"""Checks the numbers of a URDF that only Drake reads, where their file and line are still known."""

from collections.abc import Iterator, Mapping

from lxml import etree

from drake_twin.description.xml_reader import XmlReader
from drake_twin.values import LARGEST

# Element → attribute → how many numbers it holds. Limits are read elsewhere, and have no bound.
_NUMBERS: Mapping[str, Mapping[str, int]] = {
    "origin": {"xyz": 3, "rpy": 3},
    "axis": {"xyz": 3},
    "mass": {"value": 1},
    "inertia": {"ixx": 1, "ixy": 1, "ixz": 1, "iyy": 1, "iyz": 1, "izz": 1},
    "box": {"size": 3},
    "sphere": {"radius": 1},
    "cylinder": {"radius": 1, "length": 1},
    "capsule": {"radius": 1, "length": 1},
    "mesh": {"scale": 3},
    "dynamics": {"damping": 1, "friction": 1},
    "mimic": {"multiplier": 1, "offset": 1},
    "color": {"rgba": 4},
}
_NEVER_NEGATIVE = ("mass", "dynamics")


def check_values(reader: XmlReader) -> None:
    """Check every number of a URDF's links, joints and materials that is used.

    Raises:
        InputError: If one is not a number, not finite, absurdly large, or negative where it cannot be.
    """
    for element in _elements(reader.root):
        for attribute, count in _NUMBERS.get(str(element.tag), {}).items():
            text = element.get(attribute)
            if text is None:
                continue
            values = reader.parse_numbers(element, text, attribute, count)
            if any(abs(value) > LARGEST for value in values):
                raise reader.error(element, f"{attribute} is {text!r}, which is larger than {LARGEST:g}")
            if element.tag in _NEVER_NEGATIVE and values[0] < 0:
                raise reader.error(element, f"{attribute} is {text!r}, but it cannot be negative")


def _elements(root: etree._Element) -> Iterator[etree._Element]:
    for child in root:
        if child.tag in ("link", "joint", "material"):
            yield from child.iter()
