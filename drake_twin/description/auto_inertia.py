"""SDF's ``<inertial auto="true">``: the mass and inertia of a link that follow from its collisions and densities."""

from collections.abc import Iterator
from math import isfinite, pi
from typing import TYPE_CHECKING, Any

import numpy as np
from lxml import etree

from drake_twin.description.possible_inertia import MOMENTS
from drake_twin.description.sdf_document import is_within_static, number_in
from drake_twin.description.sdf_pose import transform_of
from drake_twin.description.sdf_shapes import FindFile, mesh_scale, sizes_of
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.values import is_true

if TYPE_CHECKING:
    from pydrake.multibody.tree import SpatialInertia

_DENSITY = 1000.0  # kg/m³: SDFormat's, of what gives none


def give_auto_inertias(model: etree._Element, reader: XmlReader, find: FindFile) -> Iterator[str]:
    """Write the masses and inertias that are to follow from collisions, as libsdformat's ``ResolveAutoInertials``.

    The density is a collision's, else the link's, else 1000 kg/m³. A given mass scales the result. Meshes are solids
    within their triangles; of one that is open, the triangles are taken as they are, as Gazebo does.

    Args:
        model: The model; it is changed.
        reader: The document it stands in.
        find: Resolves an address in a file.

    Yields:
        What has no volume, or lacks a density.
    """
    for link in model.iter("link"):
        inertial, name = link.find("inertial"), link.get("name", "")
        if inertial is None or not is_true(inertial.get("auto")) or is_within_static(link):
            continue
        total, own, lacks = None, number_in(inertial.find("density")), False
        for collision in link.findall("collision"):
            density = number_in(collision.find("density"))
            density = own if density is None else density
            lacks = lacks or density is None
            try:
                found = _inertia(collision, _DENSITY if density is None else density, reader, find)
            except InputError as error:
                yield f"link {name}: a collision does not count for its inertia: {str(error).rstrip('.')}"
                continue
            if found is None:
                shape = collision.find("geometry")
                kind = "shape" if shape is None or not len(shape) else f"<{shape[0].tag}>"
                yield f"link {name}: a collision {kind} does not count for its inertia: it has no volume"
            elif total is None:
                total = found
            else:
                total += found
        mass = number_in(inertial.find("mass"))
        if total is None:
            del inertial.attrib["auto"]
            yield f'link {name}: its inertia is auto="true", and no collision has a volume: it is that of 1 kg'
            continue
        if lacks and mass is None:
            weighs = f"it weighs {total.get_mass():.4g} kg by {_DENSITY:g} kg/m³, as in Gazebo"
            yield f"link {name}: a collision has no <density>: {weighs}"
        _write(inertial, total, mass)


def _inertia(collision: etree._Element, density: float, reader: XmlReader, find: FindFile) -> "SpatialInertia | None":
    """Return the inertia of a collision about the link's origin, in its axes; None without a volume.

    Raises:
        InputError: If a mesh cannot be read, or a pose or a density is invalid.
    """
    from pydrake.math import RigidTransform

    geometry, pose = collision.find("geometry"), collision.find("pose")
    kind = None if geometry is None else next((child for child in geometry if isinstance(child.tag, str)), None)
    if not isfinite(density) or density <= 0.0:
        raise reader.error(collision, f"its density is {density:g} kg/m³, and has to be above zero")
    if pose is not None and pose.get("relative_to"):
        raise reader.error(pose, f"its pose is relative to {pose.get('relative_to')!r}")
    of_shape = None if kind is None else _of_shape(kind, density, reader, find)
    if of_shape is None:
        return None
    X_LC = RigidTransform() if pose is None else transform_of(pose, reader)
    return of_shape.ReExpress(X_LC.rotation()).Shift(-X_LC.translation())


def _of_shape(kind: etree._Element, density: float, reader: XmlReader, find: FindFile) -> "SpatialInertia | None":
    """Return the inertia of a shape about the origin of its frame."""
    from pydrake.geometry import Box, Capsule, Cylinder, Ellipsoid, Sphere
    from pydrake.multibody.tree import CalcSpatialInertia, RotationalInertia, SpatialInertia

    if kind.tag == "mesh":
        return _of_mesh(kind, density, reader, find)
    sizes = sizes_of(kind)
    if sizes is None:
        return None
    if kind.tag == "cone":  # whose frame is halfway between base and tip
        radius, length = sizes
        mass = density * pi * radius**2 * length / 3.0
        across, along = 0.0375 * mass * (4.0 * radius**2 + length**2), 0.3 * mass * radius**2
        central = RotationalInertia(across, across, along)
        return SpatialInertia.MakeFromCentralInertia(mass, [0.0, 0.0, -length / 4.0], central)
    shapes: dict[str, Any] = {
        "box": Box,
        "sphere": Sphere,
        "cylinder": Cylinder,
        "capsule": Capsule,
        "ellipsoid": Ellipsoid,
    }
    return CalcSpatialInertia(shapes[str(kind.tag)](*sizes), density)


def _of_mesh(mesh: etree._Element, density: float, reader: XmlReader, find: FindFile) -> "SpatialInertia | None":
    from pydrake.geometry import SurfaceTriangle, TriangleSurfaceMesh
    from pydrake.multibody.tree import CalcSpatialInertia

    from drake_twin.description.meshes import read_triangles

    scale = mesh_scale(mesh)
    if scale is None:
        return None
    found = read_triangles(find((mesh.findtext("uri") or "").strip(), reader.file))
    corners = np.asarray(found.vertices) * scale
    faces = np.asarray(found.faces)
    volume = np.linalg.det(corners[faces]).sum() / 6.0
    if abs(volume) <= 1e-9 * np.ptp(corners, axis=0).max() ** 3:
        return None
    if volume < 0.0:
        faces = faces[:, ::-1]
    triangles = [SurfaceTriangle(*map(int, face)) for face in faces]
    return CalcSpatialInertia(TriangleSurfaceMesh(triangles, list(corners)), density)


def _write(inertial: etree._Element, total: "SpatialInertia", mass: float | None) -> None:
    scale = 1.0 if mass is None else mass / total.get_mass()
    center = total.get_com()
    tensor = scale * total.Shift(center).CalcRotationalInertia().CopyToFullMatrix3()
    for child in [*inertial.iterchildren("pose", "mass", "inertia", "density", "auto_inertia_params")]:
        inertial.remove(child)
    etree.SubElement(inertial, "pose").text = f"{' '.join(f'{float(value):.17g}' for value in center)} 0 0 0"
    etree.SubElement(inertial, "mass").text = f"{total.get_mass() if mass is None else mass:.17g}"
    element = etree.SubElement(inertial, "inertia")
    for name, (row, column) in MOMENTS.items():
        etree.SubElement(element, name).text = f"{float(tensor[row, column]):.17g}"
    inertial.attrib.pop("auto", "")
