"""The numbers of a URDF that Drake is given unseen: each is checked where its file and line are still known."""

from collections.abc import Iterator, Mapping

from lxml import etree

from drake_twin.description.xml_reader import XmlReader

# What no robot has in m, kg, kg·m² or N·m·s; more overflows somewhere in the simulation.
_LARGEST = 1e12

# Element → attribute → how many numbers it holds. Limits are read, and may be as large as they like, elsewhere.
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
    """Checks every number of a URDF's links, joints and materials that has a meaning.

    Raises:
        InputError: one that is no number, not finite, absurdly large, or negative where nothing in nature is.
    """
    for element in _elements(reader.root):
        for attribute, count in _NUMBERS.get(str(element.tag), {}).items():
            text = element.get(attribute)
            if text is None:
                continue
            values = reader.parse_numbers(element, text, attribute, count)
            if any(abs(value) > _LARGEST for value in values):
                raise reader.error(element, f"{attribute} is {text!r}, which is larger than anything on a robot")
            if element.tag in _NEVER_NEGATIVE and values[0] < 0:
                raise reader.error(element, f"{attribute} is {text!r}, and cannot be negative")


def _elements(root: etree._Element) -> Iterator[etree._Element]:
    for child in root:
        if child.tag in ("link", "joint", "material"):
            yield from child.iter()
