"""Repairs of masses and inertias."""

from collections.abc import Iterable, Mapping
from math import inf, isfinite

import numpy as np
from lxml import etree

from drake_twin.description.possible_inertia import LEAST_MASS, possible_inertia, small_sphere
from drake_twin.description.repairs import Mended, repair
from drake_twin.description.xml_reader import XmlReader, described
from drake_twin.values import number_or_none

_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@repair("inertia")
def inertia(reader: XmlReader) -> Mended:
    """Replace principal moments that no body has by the nearest possible; give a mass without inertia a sphere's."""
    for link in reader.root.iterfind("link"):
        inertial = link.find("inertial")
        if inertial is None:
            continue
        mass_element, element = inertial.find("mass"), inertial.find("inertia")
        mass = None if mass_element is None else number_or_none(mass_element.get("value"))
        if mass_element is None or mass == 0:
            # Drake would take such a link for one of 1 kg.
            link.remove(inertial)
            if element is not None and any(number_or_none(element.get(name, "0")) for name in _MOMENTS):
                yield link, f"{described(link)} has inertia but no mass: its inertia is removed"
            continue
        if mass is None or not 0 < mass < inf:
            continue  # refused where it is read
        if element is None:
            element = etree.SubElement(inertial, "inertia")
        values = {name: number_or_none(element.get(name, "0")) for name in _MOMENTS}
        if any(value is None or not isfinite(value) for value in values.values()):
            continue  # refused where it is read
        numbers = {name: float(value or 0.0) for name, value in values.items()}
        possible, why = possible_inertia(mass, _tensor(numbers))
        if why is not None:
            _set_tensor(element, possible)
            yield link, f"{described(link)}: {why}"


def _tensor(numbers: Mapping[str, float]) -> np.ndarray:
    ixx, ixy, ixz, iyy, iyz, izz = (numbers[name] for name in _MOMENTS)
    return np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])


def _set_tensor(element: etree._Element, tensor: np.ndarray) -> None:
    rows, columns = (0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2)
    for name, row, column in zip(_MOMENTS, rows, columns, strict=True):
        element.set(name, f"{float(tensor[row, column]):.17g}")


@repair("massless_link")
def massless_link(reader: XmlReader) -> Mended:
    """Give a small mass to a link whose joint moves no mass: Drake cannot accelerate it otherwise."""
    parents: dict[str, str] = {}
    moved: list[str] = []
    rigid_parents: dict[str, str] = {}
    for joint in reader.root.iterfind("joint"):
        parent, child = joint.find("parent"), joint.find("child")
        if parent is None or child is None:
            return  # refused where it is read
        parents[child.get("link", "")] = parent.get("link", "")
        if joint.get("type") == "fixed":
            rigid_parents[child.get("link", "")] = parent.get("link", "")
        else:
            moved.append(child.get("link", ""))
    links = {link.get("name", ""): link for link in reader.root.iterfind("link")}
    heavy = [
        name
        for name, link in links.items()
        if (mass := link.find("inertial/mass")) is not None and number_or_none(mass.get("value")) != 0
    ]
    # What is not a mass is refused where it is read. A joint's child may leave the mass to what it carries; a floating
    # root may turn about what it carries, so it, or what is fixed to it, must weigh something itself.
    carrying = _with_all_above(heavy, parents)
    roots = [name for name in links if name not in parents and name != "world"]
    light = [name for name in roots if name not in _with_all_above(heavy, rigid_parents)]
    light += [name for name in moved if name in links and name not in carrying]
    for name in dict.fromkeys(light):
        link = links[name]
        for inertial in link.findall("inertial"):
            link.remove(inertial)
        inertial = etree.SubElement(link, "inertial")
        etree.SubElement(inertial, "mass", value=f"{LEAST_MASS:g}")
        _set_tensor(etree.SubElement(inertial, "inertia"), small_sphere(LEAST_MASS))
        yield link, f"{described(link)} moves, but has no mass: it weighs {LEAST_MASS:g} kg"


def _with_all_above(names: Iterable[str], parents: Mapping[str, str]) -> set[str]:
    found: set[str] = set()
    for name in names:
        above: str | None = name
        while above is not None and above not in found:
            found.add(above)
            above = parents.get(above)
    return found
