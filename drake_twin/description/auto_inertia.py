"""``<inertial auto="true">`` of SDF: the mass and the inertia of links from their collision shapes and a density.

The rules are those of libsdformat's src/Link.cc and src/Collision.cc, the integral of meshes that of a solid.
"""

from collections.abc import Callable, Iterator
from math import isfinite, pi
from pathlib import Path
from typing import NamedTuple

import numpy as np
from lxml import etree

from drake_twin.description.sdf_document import is_within_static, number_in, numbers_in
from drake_twin.description.sdf_pose import pose_transform
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.values import is_true

_WATER = 1000.0  # kg/m³: SDF's default
_MOMENTS = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
_LEAST = 1e-12  # m³: a smaller volume is that of a mesh that encloses nothing


class Solid(NamedTuple):
    """The moments of a volume.

    Attributes:
        volume: The volume (m³).
        center: Its center (m, shape (3,)).
        spread: The integral of (x - center) (x - center)ᵀ over it (m⁵, 3×3).
    """

    volume: float
    center: np.ndarray
    spread: np.ndarray


def fill_auto_inertias(
    model: etree._Element, reader: XmlReader, find: Callable[[str, Path | None], Path]
) -> Iterator[str]:
    """Give each link of a model that asks for it, and of those inside it, mass, center and inertia of its shapes.

    Args:
        model: The model, before anything else is changed in it.
        reader: The document it stands in.
        find: Resolves an address in a file.

    Yields:
        The shapes that take no part in it.
    """
    for inertial in model.iterfind(".//link/inertial[@auto]"):
        link = inertial.getparent()
        is_auto = is_true(str(inertial.attrib.pop("auto", "")))
        if link is None or not is_auto or is_within_static(link):
            continue
        own = _density(inertial, _WATER)
        mass, moment, spread = 0.0, np.zeros(3), np.zeros((3, 3))
        for collision in link.findall("collision"):
            try:
                solid = _solid(collision, reader, find)
            except (InputError, ValueError) as error:
                what = (
                    f"collision {collision.get('name', '')} of link {link.get('name', '')} has no part in its inertia"
                )
                yield f"{what}: {str(error).rstrip('.')}"
                continue
            density = _density(collision, own)
            mass += density * solid.volume
            moment += density * solid.volume * solid.center
            spread += density * (solid.spread + solid.volume * np.outer(solid.center, solid.center))
        if mass > 0.0:
            _set(inertial, mass, moment / mass, spread - np.outer(moment, moment) / mass)


def _density(element: etree._Element, default: float) -> float:
    value = number_in(element.find("density"))
    return value if value is not None and isfinite(value) and value > 0.0 else default


def _set(inertial: etree._Element, mass: float, center: np.ndarray, spread: np.ndarray) -> None:
    """Replace what an ``<inertial>`` says, but for the added mass of a fluid."""
    for tag in ("pose", "mass", "inertia", "density"):
        for old in inertial.findall(tag):
            inertial.remove(old)
    tensor = np.trace(spread) * np.eye(3) - spread
    etree.SubElement(inertial, "pose").text = " ".join([*(f"{value:.17g}" for value in center.tolist()), "0 0 0"])
    etree.SubElement(inertial, "mass").text = f"{mass:.17g}"
    inertia = etree.SubElement(inertial, "inertia")
    for name, place in _MOMENTS.items():
        etree.SubElement(inertia, name).text = f"{float(tensor[place]):.17g}"


def _solid(collision: etree._Element, reader: XmlReader, find: Callable[[str, Path | None], Path]) -> Solid:
    """Return the solid of a collision shape in its link's frame."""
    geometry = collision.find("geometry")
    shape = None if geometry is None else next((item for item in geometry if isinstance(item.tag, str)), None)
    if shape is None:
        raise ValueError("it has no shape")
    solid = _of_mesh(shape, reader, find) if shape.tag == "mesh" else _of_shape(shape)
    pose = collision.find("pose")
    if pose is None:
        return solid
    X = pose_transform(pose)
    R = X.rotation().matrix()
    return Solid(solid.volume, R @ solid.center + X.translation(), R @ solid.spread @ R.T)


def _of_shape(shape: etree._Element) -> Solid:
    def size(tag: str, count: int = 1) -> list[float]:
        values = [value for value in numbers_in(shape.findtext(tag)) if value is not None and 0.0 < value < np.inf]
        if len(values) != count:
            raise ValueError(f"<{tag}> of its <{shape.tag}> is {shape.findtext(tag)!r}")
        return values

    center = np.zeros(3)
    match shape.tag:
        case "box":
            sides = np.array(size("size", 3))
            volume, squares = np.prod(sides), sides**2 / 12
        case "sphere":
            (radius,) = size("radius")
            volume, squares = 4 / 3 * pi * radius**3, np.full(3, radius**2 / 5)
        case "ellipsoid":
            radii = np.array(size("radii", 3))
            volume, squares = 4 / 3 * pi * np.prod(radii), radii**2 / 5
        case "cylinder":
            (radius,), (length,) = size("radius"), size("length")
            volume, squares = pi * radius**2 * length, np.array([radius**2 / 4, radius**2 / 4, length**2 / 12])
        case "cone":  # its frame is halfway up
            (radius,), (length,) = size("radius"), size("length")
            volume, center = pi * radius**2 * length / 3, np.array([0.0, 0.0, -length / 4])
            squares = np.array([0.15 * radius**2, 0.15 * radius**2, 0.0375 * length**2])
        case "capsule":
            (radius,), (length,) = size("radius"), size("length")
            tube, ball = pi * radius**2 * length, 4 / 3 * pi * radius**3
            across = tube * radius**2 / 4 + ball * radius**2 / 5
            along = tube * length**2 / 12 + ball * (radius**2 / 5 + length**2 / 4 + 3 / 8 * length * radius)
            volume = tube + ball
            squares = np.array([across, across, along]) / volume
        case _:
            raise ValueError(f"a <{shape.tag}> has no volume here")
    return Solid(float(volume), center, float(volume) * np.diag(squares))


def _of_mesh(mesh: etree._Element, reader: XmlReader, find: Callable[[str, Path | None], Path]) -> Solid:
    from drake_twin.description.meshes import read_triangles

    scale = numbers_in(mesh.findtext("scale") or "1 1 1")
    if len(scale) != 3 or any(value is None for value in scale):
        raise ValueError(f"the scale of its mesh is {mesh.findtext('scale')!r}")
    found = read_triangles(find((mesh.findtext("uri") or "").strip(), reader.file))
    corners = np.asarray(found.vertices)[np.asarray(found.faces)] * np.array(scale, dtype=float)  # n×3×3
    sixth = np.linalg.det(corners) / 6  # of a tetrahedron with its tip at the origin
    volume = float(sixth.sum())
    if abs(volume) < _LEAST:
        raise ValueError("its mesh encloses nothing")
    sums = corners.sum(axis=1)
    center = sixth @ sums / (4 * volume)
    squares = np.einsum("n,ni,nj->ij", sixth, sums, sums) + np.einsum("n,nki,nkj->ij", sixth, corners, corners)
    spread = squares / 20 - volume * np.outer(center, center)
    return Solid(abs(volume), center, spread if volume > 0.0 else -spread)
