"""Values of SDF that are not numbers, with which Gazebo refuses a file, and where Drake's parser refuses one."""

import re
from collections.abc import Iterator, Mapping
from math import isnan

from lxml import etree

from drake_twin.description.xml_reader import XmlReader, described
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind, at_places
from drake_twin.values import needed, number_or_none

_ONE, _THREE, _COLOR = (1, 1), (3, 3), (3, 4)
_OF_PARENT: Mapping[str, Mapping[str, tuple[int, int]]] = {
    "inertial": {"mass": _ONE},
    "inertia": dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), _ONE),
    "box": {"size": _THREE},
    "plane": {"size": (2, 2), "normal": _THREE},
    "sphere": {"radius": _ONE},
    "cylinder": {"radius": _ONE, "length": _ONE},
    "capsule": {"radius": _ONE, "length": _ONE},
    "cone": {"radius": _ONE, "length": _ONE},
    "ellipsoid": {"radii": _THREE},
    "mesh": {"scale": _THREE},
    "ode": {"mu": _ONE, "mu2": _ONE},
    "limit": dict.fromkeys(("lower", "upper", "effort", "velocity"), _ONE),
    "dynamics": dict.fromkeys(("damping", "friction", "spring_reference", "spring_stiffness"), _ONE),
    "axis": {"xyz": _THREE},
    "axis2": {"xyz": _THREE},
    "material": {"diffuse": _COLOR, "ambient": _COLOR, "emissive": _COLOR},
    "sensor": {"update_rate": _ONE},
    # Of lights only where they are empty: `surroundings` reports other words.
    "light": {"diffuse": _COLOR, "direction": _THREE, "intensity": _ONE},
    "attenuation": dict.fromkeys(("constant", "linear", "quadratic"), _ONE),
    "spot": {"outer_angle": _ONE},
}
_NEVER_NEGATIVE = ("mu", "mu2")
_FAILED_CHECK = "Failure at "  # of Drake's own code, which does not tell what is wrong in the file
_UNREADABLE = "Error reading element <"
_OF_LIGHTS = ("light", "attenuation", "spot")


def wrong_numbers(reader: XmlReader, root: etree._Element) -> list[Finding]:
    """Report each value of a model or a world that is not as many numbers as SDF has there, with its lines."""
    return list(at_places(Kind.WARNING, ((what, reader.place(element)) for element, what in _wrong(root))))


def _wrong(root: etree._Element) -> Iterator[tuple[etree._Element, str]]:
    for parent in root.iter(*_OF_PARENT):
        for element in parent.iterchildren(etree.Element):
            counts, words = _OF_PARENT[str(parent.tag)].get(str(element.tag)), (element.text or "").split()
            is_reported = bool(words) and parent.tag in _OF_LIGHTS
            why = None if counts is None or len(element) or is_reported else _why(words, *counts)
            if counts is not None and why is None and element.tag in _NEVER_NEGATIVE and float(words[0]) < 0:
                why = "which cannot be negative"
            if why is not None:
                yield element, f"<{element.tag}> of <{parent.tag}> is {' '.join(words)!r}, {why}: Gazebo refuses it"


def _why(words: list[str], least: int, most: int) -> str | None:
    for word in words:
        value = number_or_none(word)
        if value is None or isnan(value):
            return f"where {word!r} is not a number" if len(words) > 1 else "which is not a number"
    return None if least <= len(words) <= most else f"where {needed(least)}"


def with_place(error: InputError, reader: XmlReader) -> InputError:
    """Return an error of Drake's reader with a line: of what it names, of the first wrong number, or of the model."""
    wrong, why = next(_wrong(reader.root), (None, ""))
    elements = _named(error.message, reader.root), wrong, reader.root.find("model")
    element = next((item for item in elements if item is not None), None)
    if element is None or error.line is not None:
        return error
    place = reader.place(element)
    what = why if element is wrong and _FAILED_CHECK in error.message else error.message
    if _UNREADABLE in error.message and not len(element):
        what = f"{described(element)} is {' '.join((element.text or '').split())!r}, which SDF does not read there"
    return InputError(what, file=place.file or error.file, line=place.line)


def _named(message: str, root: etree._Element) -> etree._Element | None:
    """Return the element that a message of libsdformat is about."""
    path = re.search(r"At XML path (/sdf\S*?):? ", message)
    if path is not None:
        return _at(path[1].rstrip(":"), root)
    twice = re.search(r"Non-unique name\[([^\]]+)\]", message)
    if twice is not None:
        return next(iter([item for item in root.iter(etree.Element) if item.get("name") == twice[1]][1:]), None)
    frame = re.search(r"frame with name \[([^\]]+)\]", message)
    if frame is not None:
        names = ("relative_to", "attached_to")
        return next((item for item in root.iter(etree.Element) if frame[1] in map(item.get, names)), None)
    for tag, name in re.findall(r"by (\w+) with name\[([^\]]+)\]", message):
        found = next((item for item in root.iter(tag) if item.get("name") == name), None)
        if found is not None:
            return found
    return None


def _at(path: str, root: etree._Element) -> etree._Element | None:
    try:
        found = root.getroottree().xpath(path)
    except etree.XPathError:
        return None
    elements = found if isinstance(found, list) else []
    return next((item for item in elements if isinstance(item, etree._Element)), None)
