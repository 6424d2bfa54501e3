"""The visuals and collisions of an SDF model, prepared for Drake's parser: shapes, meshes, colours, friction."""

import os
from collections.abc import Callable, Iterator
from math import inf, isfinite
from pathlib import Path

import numpy as np
from lxml import etree

from drake_twin.description.gazebo_colors import GAZEBO_COLORS
from drake_twin.description.lasting_files import lasting_file
from drake_twin.description.mesh_findings import said_of_hull, said_of_hulls, said_of_visual
from drake_twin.description.meshes import collision_mesh, mesh_address, mesh_primitive, visual_mesh
from drake_twin.description.package_index import MissingPackageError
from drake_twin.description.robot_description import Pose
from drake_twin.description.sdf_document import is_within_static, number_in, numbers_in
from drake_twin.description.sdf_pose import pose_transform
from drake_twin.description.used_elements import weight_of
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.findings import Weight
from drake_twin.values import LARGEST

_DRAKE_NAMESPACE = "http://drake.mit.edu"

_SIZES = {
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "cone": ("radius", "length"),
    "ellipsoid": ("radii",),
}
# What is not there has the value of SDFormat's description of the shape.
_DEFAULTS = {"size": "1 1 1", "radius": "1", "length": "1", "radii": "1 1 1"}
_OF_CAPSULE = {"radius": "0.5"}
_SHAPES = (*_SIZES, "plane", "mesh")
_COUNTS = {"size": 3, "radii": 3}  # of numbers; else one
_CONE_SIDES = 48

FindFile = Callable[[str, Path | None], Path]


def mend_shapes(model: etree._Element) -> Iterator[tuple[str, Weight]]:
    """Change the shapes, colours and friction of a model, except for its planes and meshes.

    Yields:
        What was left out, and what it was for.
    """
    yield from _shapes(model)
    for cone in [*model.iterfind(".//geometry/cone")]:
        _replace_cone(cone)
    _give_colors(model)
    _give_friction(model)


def _shapes(model: etree._Element) -> Iterator[tuple[str, Weight]]:
    """Leave out shapes that Drake does not support, or without a size."""
    for shape in [*model.iter("collision", "visual")]:
        link, geometry = shape.getparent(), shape.find("geometry")
        assert link is not None
        kinds = [child for child in geometry if isinstance(child.tag, str)] if geometry is not None else []
        kind = kinds[0] if kinds else None
        if kind is not None and (added := _complete(kind)):
            yield f"a {shape.tag} <{kind.tag}> has {added}, as in Gazebo: it gives none", weight_of(shape)
        reason = None
        if kind is None or kind.tag == "empty":
            reason = ""
        elif kind.tag not in _SHAPES:
            reason = f"a {shape.tag} <{kind.tag}> is left out: Drake does not support it"
        elif kind.tag in _SIZES and not all(_has_size(kind.find(tag)) for tag in _SIZES[str(kind.tag)]):
            reason = f"a {shape.tag} <{kind.tag}> has no size{_written(kind)}: it is left out"
        elif kind.tag == "plane" and shape.tag == "collision" and not is_within_static(shape):
            reason = "a collision <plane> of a model that moves is left out: Drake does not support it"
        if reason is not None:
            link.remove(shape)
            if reason:
                yield reason, weight_of(shape)
        elif kind is not None and kind.tag == "plane":
            yield from ((what, weight_of(shape)) for what in _wrong_in_plane(kind, shape))


def _complete(kind: etree._Element) -> str:
    """Add the sizes that a shape does not give; return what was added."""
    added = []
    for tag in _SIZES.get(str(kind.tag), ()):
        if kind.find(tag) is None:
            etree.SubElement(kind, tag).text = _default(kind, tag)
            added.append(f"the {tag} {_default(kind, tag)}")
    return " and ".join(added)


def _default(kind: etree._Element, tag: str) -> str:
    return (_OF_CAPSULE if kind.tag == "capsule" else {}).get(tag, _DEFAULTS[tag])


def sizes_of(kind: etree._Element) -> list[float] | None:
    """Return the sizes of a shape with some, one after the other (m); None for one without, or with invalid ones."""
    found: list[float] = []
    for tag in _SIZES.get(str(kind.tag), ()):
        element = kind.find(tag)
        sizes = _sizes(tag, _default(kind, tag) if element is None else element.text)
        if sizes is None:
            return None
        found += sizes
    return found or None


def _sizes(tag: str, text: str | None) -> list[float] | None:
    sizes = [size for size in numbers_in(text) if size is not None and 0 < size < LARGEST]
    return sizes if len(sizes) == len((text or "").split()) == _COUNTS.get(tag, 1) else None


def _has_size(element: etree._Element | None) -> bool:
    return element is not None and _sizes(str(element.tag), element.text) is not None


def _written(kind: etree._Element) -> str:
    """Return what a shape says of its size, in brackets."""
    texts = [f"<{child.tag}>{(child.text or '').strip()}" for child in kind if child.tag in _SIZES[str(kind.tag)]]
    return f" ({' '.join(texts)})" if texts else ""


def _replace_cone(cone: etree._Element) -> None:
    """Replace a ``<cone>`` by a mesh: with its tip along z and its frame halfway between base and tip, as in SDF."""
    radius, length = (float(cone.findtext(tag) or "") for tag in _SIZES["cone"])
    angles = 2 * np.pi * np.arange(_CONE_SIDES) / _CONE_SIDES
    base = np.round(radius * np.column_stack([np.cos(angles), np.sin(angles)]), 12)
    lines = [f"v {x!r} {y!r} {-length / 2!r}" for x, y in base.tolist()] + [f"v 0 0 {length / 2!r}"]
    lines += [f"f {i + 1} {(i + 1) % _CONE_SIDES + 1} {_CONE_SIDES + 1}" for i in range(_CONE_SIDES)]
    lines += [f"f 1 {i + 1} {i}" for i in range(2, _CONE_SIDES)]
    cone.tag = "mesh"
    for child in [*cone]:
        cone.remove(child)
    etree.SubElement(cone, "uri").text = str(lasting_file("cone.obj", "\n".join([*lines, ""])))


def _give_colors(model: etree._Element) -> None:
    """Give each visual one colour: ``<diffuse>``, else that of Gazebo's material script, else ``<ambient>``.

    What it emits, such as a lamp, is added.
    """
    for visual in model.iter("visual"):
        color, emitted = None, [0.0, 0.0, 0.0]
        for material in visual.findall("material"):
            script = (material.findtext("script/name") or "").strip().rpartition("/")[2]
            color = material.findtext("diffuse") or GAZEBO_COLORS.get(script) or material.findtext("ambient")
            light = numbers_in(material.findtext("emissive"))[:3]
            if len(light) == 3 and all(part is not None and 0 <= part < inf for part in light):
                emitted = [part or 0.0 for part in light]
            visual.remove(material)
        transparency = number_in(visual.find("transparency")) or 0.0
        for element in visual.findall("transparency"):
            visual.remove(element)
        parts = numbers_in(color)
        if len(parts) not in (3, 4) or any(part is None or not isfinite(part) for part in parts):
            is_mesh = visual.find("geometry/mesh") is not None  # which has colours of its own
            parts = (
                [] if is_mesh else [0.0, 0.0, 0.0] if any(emitted) else [0.7, 0.7, 0.7, 1.0] if transparency > 0 else []
            )
        if parts:
            values = [part or 0.0 for part in parts] + [1.0] * (4 - len(parts))
            values = [min(max(part, 0.0) + more, 1.0) for part, more in zip(values, [*emitted, 0.0], strict=True)]
            values[3] *= 1 - min(max(transparency, 0.0), 1.0)
            diffuse = etree.SubElement(etree.SubElement(visual, "material"), "diffuse")
            diffuse.text = " ".join(f"{value:g}" for value in values)


def _give_friction(model: etree._Element) -> None:
    """Give each collision its smallest coefficient of friction, in the way Drake reads it."""
    for collision in model.iter("collision"):
        mus = [1.0, 1.0]  # SDF's default
        for index, name in enumerate(("mu", "mu2")):  # of <ode>, which DART, Gazebo's default engine, reads as well
            value = number_in(collision.find(f"surface/friction/ode/{name}"))
            if value is not None and value >= 0:
                mus[index] = value
        for surface in collision.findall("surface"):
            collision.remove(surface)
        friction = min(mus)
        properties = etree.SubElement(
            collision, f"{{{_DRAKE_NAMESPACE}}}proximity_properties", nsmap={"drake": _DRAKE_NAMESPACE}
        )
        for name in ("mu_dynamic", "mu_static"):
            etree.SubElement(properties, f"{{{_DRAKE_NAMESPACE}}}{name}").text = f"{friction:.17g}"


def lay_slabs(model: etree._Element) -> None:
    """Replace the plane of each collision of a robot that does not move by a box whose upper side is the plane."""
    for plane in [*model.iterfind(".//collision/geometry/plane")]:
        width, length = (max(side, _ENDLESS) for side in plane_size(plane))
        _replace_plane(plane, (width, length, _DEEP))


def mend_planes(model: etree._Element) -> None:
    """Replace the plane of each visual by a thin box of its size, whose upper side is the plane."""
    for plane in [*model.iterfind(".//visual/geometry/plane")]:
        _replace_plane(plane, (*plane_size(plane), _THIN))


def _replace_plane(plane: etree._Element, size: tuple[float, float, float]) -> None:
    geometry = plane.getparent()
    assert geometry is not None
    shape = geometry.getparent()
    assert shape is not None
    geometry.remove(plane)
    box = etree.SubElement(etree.SubElement(geometry, "box"), "size")
    box.text = " ".join(f"{side:g}" for side in size)
    _move_shape(shape, turned_to(plane_normal(plane)), np.array([0.0, 0.0, -size[2] / 2]))


_THIN = 1e-3  # m
_ENDLESS, _DEEP = 100.0, 1.0  # m: a plane has no end in Gazebo, whatever its size
_HUGE = 1e100  # of a normal's numbers, whose squares are numbers, too
_PLANE = 100.0  # m; of a plane without a possible size


def _wrong_in_plane(plane: etree._Element, shape: etree._Element) -> Iterator[str]:
    """Yield what of a ``<plane>`` cannot be used, and what is used instead; ground is endless, whatever its size."""
    size, normal = (" ".join((plane.findtext(tag) or "").split()) for tag in ("size", "normal"))
    if size and shape.tag == "visual" and plane_size(plane) != tuple(numbers_in(size)):
        drawn = " by ".join(f"{side:g}" for side in plane_size(plane))
        yield f"a visual <plane> has the size {size!r}: it is drawn {drawn} m large"
    if normal and plane_normal(plane).tolist() != numbers_in(normal):
        yield f"a {shape.tag} <plane> has the normal {normal!r}: it faces along z"


def plane_size(plane: etree._Element) -> tuple[float, float]:
    """Return the sides of a ``<plane>`` (m); 100 m in place of a missing or absurd one."""
    sides = [side if side is not None and 0 < side < 1e4 else _PLANE for side in numbers_in(plane.findtext("size"))]
    return (sides[0], sides[-1]) if sides else (1.0, 1.0)


def plane_normal(plane: etree._Element) -> np.ndarray:
    """Return the direction that a ``<plane>`` faces, in its shape's frame."""
    parts = numbers_in(plane.findtext("normal") or "0 0 1")
    normal = np.array([part if part is not None and isfinite(part) else 0.0 for part in parts])
    if (largest := float(np.abs(normal).max(initial=0.0))) > _HUGE:
        normal = normal / largest
    return normal if normal.shape == (3,) and np.linalg.norm(normal) > 1e-8 else np.array([0.0, 0.0, 1.0])


def turned_to(normal: np.ndarray) -> np.ndarray:
    """Return a rotation matrix that turns z to a direction."""
    from pydrake.math import RotationMatrix

    if normal[2] > 0 and not np.any(normal[:2]):
        return np.eye(3)
    return np.asarray(RotationMatrix.MakeFromOneVector(normal, 2).matrix())


def _move_shape(shape: etree._Element, rotation: np.ndarray, translation: np.ndarray) -> None:
    """Turn a visual or collision about its own frame, then move it along the turned axes (m)."""
    from pydrake.math import RigidTransform, RotationMatrix

    pose = shape.find("pose")
    if pose is None:
        pose = etree.SubElement(shape, "pose")
        pose.text = "0 0 0 0 0 0"
    X = pose_transform(pose) @ RigidTransform(RotationMatrix(rotation), rotation @ translation)
    for attribute in ("degrees", "rotation_format"):
        pose.attrib.pop(attribute, "")
    pose.text = Pose.of(X).text


def mend_meshes(model: etree._Element, reader: XmlReader, find: FindFile) -> Iterator[tuple[str, Weight]]:
    """Convert each mesh to a form that Drake reads; a static model's collision meshes stay as they are.

    Args:
        model: The model; it is changed.
        reader: The document it stands in.
        find: Resolves an address in a file.

    Yields:
        What was changed or left out, and what it is for.
    """
    colliding: dict[Path, None] = {}
    for shape in [*model.iter("collision", "visual")]:
        mesh = shape.find("geometry/mesh")
        link = shape.getparent()
        if mesh is None or link is None:
            continue
        for extra in [child for child in mesh if child.tag not in ("uri", "scale")]:
            mesh.remove(extra)
            if extra.tag == "submesh":
                yield "a <submesh> is not used: the whole mesh is", weight_of(shape)
        uri = mesh.find("uri")
        address = (mesh.findtext("uri") or "").strip()
        scale = mesh_scale(mesh)
        try:
            if uri is None or scale is None:
                raise InputError("<uri> is missing" if uri is None else "its scale lacks a number, or one is zero")
            file = find(address, reader.file)
            given = address.removeprefix("file://")
            if Path(given).is_absolute() and Path(os.path.abspath(given)) != file:
                yield f"mesh {address!r} is not on this machine: {file} is used", weight_of(shape)
            if shape.tag == "visual":
                uri.text = mesh_address(visual_mesh(file))
                yield from ((what, Weight.LOOKS) for what in said_of_visual(file))
            elif is_within_static(shape):
                uri.text = str(file)
            else:
                _give_hull(shape, mesh, file, scale)
                yield from ((what, Weight.MOVES) for what in said_of_hull(file))
                colliding[file] = None
        except MissingPackageError:
            link.remove(shape)  # reported once for all its shapes
        except InputError as error:
            link.remove(shape)
            what = f"a {shape.tag} is left out with its mesh {address}: {str(error).rstrip('.')}"
            yield what, weight_of(shape)
    yield from ((what, Weight.LOOKS) for what in said_of_hulls(colliding))


def _give_hull(shape: etree._Element, mesh: etree._Element, file: Path, scale: tuple[float, float, float]) -> None:
    """Replace a mesh by the primitive that it is, or by its convex hull."""
    primitive = mesh_primitive(file, scale)
    if primitive is None:
        uri = mesh.find("uri")
        assert uri is not None
        uri.text = mesh_address(collision_mesh(file))
        etree.SubElement(mesh, f"{{{_DRAKE_NAMESPACE}}}declare_convex", nsmap={"drake": _DRAKE_NAMESPACE})
        return
    geometry = mesh.getparent()
    assert geometry is not None
    geometry.remove(mesh)
    kind = etree.SubElement(geometry, primitive.kind)
    if primitive.kind == "box":
        etree.SubElement(kind, "size").text = " ".join(f"{side:.17g}" for side in primitive.size)
    else:
        for tag, value in zip(_SIZES[primitive.kind], primitive.size, strict=True):
            etree.SubElement(kind, tag).text = f"{value:.17g}"
    axis = np.eye(3)[primitive.axis]
    rotation = turned_to(axis) if primitive.kind == "cylinder" else np.eye(3)
    _move_shape(shape, rotation, rotation.T @ np.array(primitive.center))


def mesh_scale(mesh: etree._Element) -> tuple[float, float, float] | None:
    """Return the scale of a ``<mesh>``; None if it lacks a number, or one is zero."""
    parts = numbers_in(mesh.findtext("scale") or "1 1 1")
    values = [part for part in parts if part is not None and isfinite(part) and abs(part) > 1e-8]
    return (values[0], values[1], values[2]) if len(parts) == len(values) == 3 else None
