"""SDF's ``<fluid_added_mass>`` of a link."""

from collections.abc import Iterator, Mapping

import numpy as np
from lxml import etree

from drake_twin.description.gazebo_plugins import PluginReader
from drake_twin.description.robot_description import GazeboPlugin, Pose
from drake_twin.description.used_elements import ADDED_MASS_TAGS
from drake_twin.description.xml_reader import XmlReader
from drake_twin.values import parse_number

IMPLIED = "fluid-added-mass"  # a plugin that stands in no file: what an element of a link asks for

_ENTRIES = {tag: ("xyzpqr".index(tag[0]), "xyzpqr".index(tag[1])) for tag in ADDED_MASS_TAGS}
_POSE = "pose"
_OF_FLUIDS = ("lighter_than_air_dynamics", "lighter-than-air-dynamics", "hydrodynamics")


def fluid_added_mass(text: str, link: str, plugin: PluginReader) -> np.ndarray | None:
    """Return the added mass of a link of an SDF model (6×6), angular first; None if it has none.

    Args:
        text: The SDF.
        link: The link.
        plugin: What asks for it.

    Returns:
        About the link's origin and in its axes, from what the file has about the center of mass.

    Raises:
        InputError: If a value is invalid.
    """
    try:
        root = etree.fromstring(text.encode())
    except etree.XMLSyntaxError:
        return None
    found = next(
        (item.find("inertial/fluid_added_mass") for item in root.iter("link") if item.get("name") == link), None
    )
    return None if found is None else added_mass_of(_values(found), plugin)


def added_mass_of(values: Mapping[str, str], plugin: PluginReader) -> np.ndarray:
    """Return what `fluid_added_mass` does, from the texts of the entries and the ``pose`` of the center of mass."""
    matrix = np.zeros((6, 6))
    for tag, (i, j) in _ENTRIES.items():
        matrix[i, j] = matrix[j, i] = _number(values.get(tag) or "0", tag, plugin)
    linear_last = [3, 4, 5, 0, 1, 2]
    matrix = matrix[np.ix_(linear_last, linear_last)]
    pose = [_number(word, _POSE, plugin) for word in values.get(_POSE, "").split()]
    X = Pose((pose[0], pose[1], pose[2]), (pose[3], pose[4], pose[5])) if len(pose) == 6 else Pose()
    R, (x, y, z) = X.transform().rotation().matrix(), X.xyz
    to_center = np.zeros((6, 6))
    to_center[:3, :3] = to_center[3:, 3:] = R.T
    to_center[3:, :3] = -R.T @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    shifted: np.ndarray = to_center.T @ matrix @ to_center
    return shifted


def added_mass_plugins(reader: XmlReader, model: etree._Element) -> Iterator[GazeboPlugin]:
    """Yield what a model's links with added mass ask for, as if a plugin asked for it."""
    for link, element in _own(model):
        values = {tag: (text,) for tag, text in _values(element).items()}
        yield GazeboPlugin(IMPLIED, "", elements={"link_name": (link,), **values}, place=reader.place(element))


def _own(model: etree._Element) -> Iterator[tuple[str, etree._Element]]:
    plugins = [item for item in model.findall("plugin") if any(kind in item.get("filename", "") for kind in _OF_FLUIDS)]
    taken = {(item.findtext("link_name") or "").strip() for item in plugins}
    for link in model.findall("link"):
        element, name = link.find("inertial/fluid_added_mass"), link.get("name", "")
        if element is not None and name not in taken:
            yield name, element


def _values(element: etree._Element) -> dict[str, str]:
    inertial = element.getparent()
    pose = None if inertial is None else inertial.findtext(_POSE)
    return {child.tag: child.text or "" for child in element if child.tag in _ENTRIES} | {_POSE: pose or ""}


def _number(text: str, tag: str, plugin: PluginReader) -> float:
    try:
        return parse_number(text.strip())
    except ValueError as error:
        raise plugin.error(f"<{tag}> of the link's added mass is {text!r}, which is {error}") from None
