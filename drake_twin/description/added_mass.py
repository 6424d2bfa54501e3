"""SDF's ``<fluid_added_mass>`` of a link."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from lxml import etree

from drake_twin.description.gazebo_plugins import PluginReader
from drake_twin.description.robot_description import Pose
from drake_twin.description.xml_reader import XmlReader
from drake_twin.values import parse_number

_AXES = "xyzpqr"
_LIBRARY = "lighter_than_air_dynamics"


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
    inertial = next((item.find("inertial") for item in root.iter("link") if item.get("name") == link), None)
    found = None if inertial is None else inertial.find("fluid_added_mass")
    if inertial is None or found is None:
        return None
    return _matrix(inertial, found, lambda text, tag: _number(text, tag, plugin))


def added_masses(model: etree._Element, reader: XmlReader, inside: str = "") -> Iterator[tuple[str, tuple[float, ...]]]:
    """Yield the links of a model with added mass, and of those inside it as ``INNER::LINK``, and their matrices.

    Those that a plugin of their model is about are left out.

    Args:
        model: The model.
        reader: The document it stands in.
        inside: What comes before the links' names.

    Yields:
        A link, and its matrix row by row, as `fluid_added_mass` returns it.

    Raises:
        InputError: If a value is not a finite number; with file and line.
    """
    for found in model.iterfind("link/inertial/fluid_added_mass"):
        inertial = found.getparent()
        if inertial is None or is_used_added_mass(found):
            continue
        matrix = _matrix(inertial, found, partial(_number_at, reader, found))
        if matrix.any():
            yield f"{inside}{next(found.iterancestors('link')).get('name', '')}", tuple(matrix.ravel().tolist())
    for nested in model.iterfind("model"):
        yield from added_masses(nested, reader, f"{inside}{nested.get('name', '')}::")


def _matrix(inertial: etree._Element, found: etree._Element, number: Callable[[str, str], float]) -> np.ndarray:
    """Return the matrix of an ``<inertial>`` and its ``<fluid_added_mass>``; ``number`` reads a text of an element."""
    matrix = np.zeros((6, 6))
    for i, row in enumerate(_AXES):
        for j, column in enumerate(_AXES[i:], i):
            matrix[i, j] = matrix[j, i] = number(found.findtext(row + column) or "0", row + column)
    linear_last = [3, 4, 5, 0, 1, 2]
    matrix = matrix[np.ix_(linear_last, linear_last)]
    values = [number(word, "pose") for word in (inertial.findtext("pose") or "").split()]
    X = Pose((values[0], values[1], values[2]), (values[3], values[4], values[5])) if len(values) == 6 else Pose()
    R, (x, y, z) = X.transform().rotation().matrix(), X.xyz
    to_center = np.zeros((6, 6))
    to_center[:3, :3] = to_center[3:, 3:] = R.T
    to_center[3:, :3] = -R.T @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    shifted: np.ndarray = to_center.T @ matrix @ to_center
    return shifted


def is_used_added_mass(element: etree._Element) -> bool:
    """Tell whether an element is a ``<fluid_added_mass>`` of a link that a plugin of its model is about."""
    if element.tag != "fluid_added_mass":
        return False
    link, model = next(element.iterancestors("link"), None), next(element.iterancestors("model"), None)
    if link is None or model is None:
        return False
    plugins = (item for item in model.findall("plugin") if _LIBRARY in item.get("filename", ""))
    return any((item.findtext("link_name") or "").strip() == link.get("name") for item in plugins)


def _number_at(reader: XmlReader, element: etree._Element, text: str, tag: str) -> float:
    return reader.parse_number(element, text.strip(), tag)


def _number(text: str, tag: str, plugin: PluginReader) -> float:
    try:
        return parse_number(text.strip())
    except ValueError as error:
        raise plugin.error(f"<{tag}> of the link's added mass is {text!r}, which is {error}") from None
