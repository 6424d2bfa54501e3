"""Whether gravity acts on a robot: ``<gravity>`` of its links, and ``<turnGravityOff>`` of a URDF.

Drake has one flag for each robot: it is without weight where all its links are.
"""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from lxml import etree

from drake_twin.description.fixed_joint_lumping import lumped_links
from drake_twin.description.gazebo_tag import text_or_value, turns_gravity_off
from drake_twin.description.sdf_document import has_weight
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Finding, Kind, at_places
from drake_twin.values import is_true


class Gravity(NamedTuple):
    """Whether gravity acts on a robot, and a finding of links that have their weight against their file."""

    falls: bool
    findings: tuple[Finding, ...] = ()


def gravity_of_urdf(reader: XmlReader) -> Gravity:
    """Read it of a URDF; what Gazebo folds together has no weight where one of it has none."""
    into = lumped_links(reader.root)
    off: dict[str, etree._Element] = {}
    for element in reader.root.iterfind("gazebo[@reference]"):
        link = element.get("reference", "").strip()
        gravity = text_or_value(element, "gravity")
        if turns_gravity_off(element) or not (gravity is None or is_true(gravity)):
            off[into.get(link, link)] = element
    heavy = (link.get("name", "").strip() for link in reader.root.iterfind("link") if link.find("inertial") is not None)
    return _gravity(reader, {into.get(link, link) for link in heavy}, off)


def gravity_of_sdf(reader: XmlReader, model: etree._Element) -> Gravity:
    """Read it of an SDF model."""
    links = {link.get("name", ""): link for link in model.iterfind("link")}
    off = {name: flag for name, link in links.items() for flag in link.findall("gravity")[:1] if not has_weight(link)}
    return _gravity(reader, links, off)


def _gravity(reader: XmlReader, heavy: Iterable[str], off: Mapping[str, etree._Element]) -> Gravity:
    light = {link: element for link, element in off.items() if link in heavy}
    if not light or all(link in light for link in heavy):
        return Gravity(falls=not light)
    what = f"gravity of {', '.join(light)}: they have weight here, for a robot is without it only as a whole"
    return Gravity(
        falls=True,
        findings=tuple(at_places(Kind.IGNORED, ((what, reader.place(element)) for element in light.values()))),
    )
