"""Drake's shapes as the JSON of three.js, which the pages of PyPI's meshcat read.

A cylinder of three.js is along y, its matrices are column-major, and arrays are sent as MessagePack extensions.
"""

import base64
import uuid
from pathlib import Path
from typing import Any

import numpy as np
import umsgpack
from pydrake.geometry import (
    Box,
    Capsule,
    Convex,
    Cylinder,
    Ellipsoid,
    HalfSpace,
    Mesh,
    MeshcatCone,
    Shape,
    Sphere,
)

from drake_twin.shared_viewer.drawn_mesh import MeshPart, read_mesh
from drake_twin.shared_viewer.shared_scene import WORLD, DrawnGeometry

_REPEAT = 1000
_TEXTURE = {"wrap": [_REPEAT, _REPEAT], "repeat": [1, 1], "colorSpace": "srgb", "anisotropy": 4}
_FLOAT32, _UINT32 = ("Float32Array", 0x17), ("Uint32Array", 0x16)
_DOUBLE_SIDE = 2
_HALF_SPACE_SIDE = 100.0  # m: as large as a viewer draws an infinite plane
_HALF_SPACE_THICKNESS = 0.01  # m
_FLAT = 0.001  # m: the thickness of the box that an SDF plane is drawn as
_UPWARD = 0.999  # the cosine of its slope
_WIDE = 20.0  # m: what is so wide and flat in the world is its ground
_ROUND = {"widthSegments": 48, "heightSegments": 24}
# From the z axis of Drake's shapes to the y axis of three.js'.
_Y_TO_Z = np.array([[1.0, 0, 0, 0], [0, 0, -1.0, 0], [0, 1.0, 0, 0], [0, 0, 0, 1.0]])


def three_js_object(geometry: DrawnGeometry, **material: Any) -> dict[str, Any]:
    """Return a geometry in three.js' object format, version 4.5.

    Args:
        geometry: The geometry; the object is in its body's frame.
        material: More properties of the material of a shape that is not a mesh.

    Raises:
        ValueError: If a mesh cannot be read, or the shape cannot be drawn.
    """
    writer = _Writer(geometry.path)
    shape = geometry.shape
    if isinstance(shape, Convex):
        children = [writer.triangles(_hull(shape), geometry.color, np.eye(4))]
    elif isinstance(shape, Mesh):
        source = shape.source()
        if not source.is_path():
            raise ValueError("it is in memory and has no file")
        parts = read_mesh(Path(source.path()), np.asarray(shape.scale3()).tolist())
        children = [writer.triangles(part, geometry.color, np.eye(4)) for part in parts]
    else:
        more = (
            {"userData": {"isGround": True, "isEndless": isinstance(shape, HalfSpace)}} if _is_ground(geometry) else {}
        )
        children = [
            writer.mesh(*item, writer.material(geometry.color, **material)) | more for item in _primitives(shape)
        ]
    return writer.document(children, geometry.X_BG)


def points_object(
    path: str, points: np.ndarray, color: tuple[float, float, float] | np.ndarray, size: float
) -> dict[str, Any]:
    """Return points as an object of three.js.

    Args:
        path: Its path in the scene.
        points: The points (m), shape (n, 3).
        color: Their color: red, green, blue; or one for each, shape (n, 3).
        size: The size of each (m).
    """
    return _Writer(path).vertices("Points", points, {"type": "PointsMaterial", "size": size}, color)


def lines_object(
    path: str, ends: np.ndarray, color: tuple[float, float, float] | np.ndarray, **material: Any
) -> dict[str, Any]:
    """Return line segments as an object of three.js.

    Args:
        path: Its path in the scene.
        ends: The ends of all segments one after the other (m), shape (2 n, 3).
        color: Their color: red, green, blue; or one for each end, shape (2 n, 3).
        material: More properties of the material.
    """
    return _Writer(path).vertices("LineSegments", ends, {"type": "LineBasicMaterial", **material}, color)


def ghost_object(path: str, body: str, color: tuple[float, float, float]) -> dict[str, Any]:
    """Return an empty object of three.js, which a page fills with a translucent copy of what is drawn of a body.

    Args:
        path: Its path in the scene.
        body: The path of the body.
        color: Its color: red, green, blue.
    """
    document = _Writer(path).document([], np.eye(4))
    document["object"]["userData"] = {"copyOf": body, "color": list(color)}
    return document


def _is_ground(geometry: DrawnGeometry) -> bool:
    """Return whether a geometry is a plane without an end, or a wide one of a world that faces upward."""
    shape = geometry.shape
    if not isinstance(shape, Box) or not geometry.path.startswith(f"{WORLD}/"):
        return isinstance(shape, HalfSpace)
    is_flat = shape.height() <= _FLAT and min(shape.width(), shape.depth()) >= _WIDE
    return is_flat and float(geometry.X_BG[2, 2]) > _UPWARD


def _primitives(shape: Shape) -> list[tuple[dict[str, Any], np.ndarray]]:
    """Return the geometries of a shape, each with its matrix in the shape's frame."""
    match shape:
        case Box():
            return [(_box(shape.width(), shape.depth(), shape.height()), np.eye(4))]
        case Sphere():
            return [({"type": "SphereGeometry", "radius": shape.radius(), **_ROUND}, np.eye(4))]
        case Ellipsoid():
            radii = np.diag([shape.a(), shape.b(), shape.c(), 1.0])
            return [({"type": "SphereGeometry", "radius": 1.0, **_ROUND}, radii)]
        case Cylinder():
            return [(_cylinder(shape.radius(), shape.radius(), shape.length()), _Y_TO_Z)]
        case Capsule():
            radius, length = shape.radius(), shape.length()
            ball = {"type": "SphereGeometry", "radius": radius, **_ROUND}
            ends = [_raised(np.eye(4), sign * length / 2) for sign in (-1.0, 1.0)]
            tube = _cylinder(radius, radius, length) | {"openEnded": True}
            return [(tube, _Y_TO_Z), *((dict(ball), end) for end in ends)]
        case HalfSpace():
            plate = _box(_HALF_SPACE_SIDE, _HALF_SPACE_SIDE, _HALF_SPACE_THICKNESS)
            return [(plate, _raised(np.eye(4), -_HALF_SPACE_THICKNESS / 2))]
        case MeshcatCone():  # its tip is at the origin
            stretch = np.diag([shape.a(), shape.b(), 1.0, 1.0])
            return [(_cylinder(1.0, 0.0, shape.height()), stretch @ _raised(_Y_TO_Z, shape.height() / 2))]
    raise ValueError(f"a {type(shape).__name__} cannot be drawn")


def _box(width: float, depth: float, height: float) -> dict[str, Any]:
    return {"type": "BoxGeometry", "width": width, "height": depth, "depth": height}


def _cylinder(top: float, bottom: float, length: float) -> dict[str, Any]:
    return {
        "type": "CylinderGeometry",
        "radiusTop": top,
        "radiusBottom": bottom,
        "height": length,
        "radialSegments": 48,
    }


def _raised(matrix: np.ndarray, height: float) -> np.ndarray:
    raised = matrix.copy()
    raised[2, 3] += height
    return raised


def _hull(shape: Convex) -> MeshPart:
    """Return the faces of a convex hull, flat-shaded: each has vertices of its own."""
    hull = shape.GetConvexHull()
    vertices: list[Any] = []
    normals: list[Any] = []
    faces: list[tuple[int, int, int]] = []
    data, start = np.asarray(hull.face_data()), 0
    for face in range(hull.num_faces()):
        corners = data[start + 1 : start + 1 + data[start]]
        start += 1 + len(corners)
        first = len(vertices)
        vertices += [hull.vertex(int(corner)) for corner in corners]
        normals += [hull.face_normal(face)] * len(corners)
        faces += [(first, first + n, first + n + 1) for n in range(1, len(corners) - 1)]
    return MeshPart(np.array(vertices), np.array(normals), np.array(faces))


class _Writer:
    """Collects the lists of a three.js document: geometries, materials, textures, images.

    Identifiers follow from the path, so that an unchanged object is sent with the same bytes, which the server detects.
    """

    def __init__(self, path: str):
        self._path = path
        self._lists: dict[str, list[dict[str, Any]]] = {
            name: [] for name in ("geometries", "materials", "textures", "images")
        }
        self._objects = 0

    def mesh(self, geometry: dict[str, Any], matrix: np.ndarray, material: str) -> dict[str, Any]:
        self._objects += 1
        return {
            "uuid": self._uuid("objects", self._objects),
            "type": "Mesh",
            "geometry": self._add("geometries", geometry),
            "material": material,
            "matrix": matrix.T.ravel().tolist(),
        }

    def vertices(
        self, kind: str, vertices: np.ndarray, material: dict[str, Any], color: tuple[float, float, float] | np.ndarray
    ) -> dict[str, Any]:
        """Return a document with one object of vertices without faces."""
        attributes = {"position": _array(vertices, _FLOAT32)}
        if isinstance(color, np.ndarray):
            attributes["color"] = _array(_linear(color), _FLOAT32)
            color, material = (1.0, 1.0, 1.0), {**material, "vertexColors": True}
        geometry = {"type": "BufferGeometry", "data": {"attributes": attributes}}
        item = self.mesh(geometry, np.eye(4), self.material((*color, 1.0), **material))
        return self.document([{**item, "type": kind}], np.eye(4))

    def triangles(self, part: MeshPart, color: tuple[float, float, float, float], matrix: np.ndarray) -> dict[str, Any]:
        attributes = {"position": _array(part.vertices, _FLOAT32), "normal": _array(part.normals, _FLOAT32)}
        if part.uv is not None:
            attributes["uv"] = _array(part.uv, _FLOAT32)
        if part.vertex_colors is not None:
            attributes["color"] = _array(_linear(part.vertex_colors), _FLOAT32)
        geometry = {
            "type": "BufferGeometry",
            "data": {"attributes": attributes, "index": _array(part.faces, _UINT32)},
        }
        more: dict[str, Any] = {"vertexColors": True} if part.vertex_colors is not None else {}
        if part.texture is not None:
            url = "data:image/png;base64," + base64.b64encode(part.texture).decode("ascii")
            image = self._add("images", {"url": url})
            more["map"] = self._add("textures", _TEXTURE | {"image": image})
        return self.mesh(geometry, matrix, self.material(part.color or color, **more))

    def material(self, color: tuple[float, float, float, float], **more: Any) -> str:
        """Add a material if it is new; return its identifier."""
        red, green, blue = (round(255 * min(max(channel, 0.0), 1.0)) for channel in color[:3])
        material = {
            "type": "MeshPhongMaterial",
            "color": red << 16 | green << 8 | blue,
            "opacity": color[3],
            "transparent": color[3] < 1.0,
            "side": _DOUBLE_SIDE,
        }
        return self._add("materials", material | more)

    def document(self, children: list[dict[str, Any]], matrix: np.ndarray) -> dict[str, Any]:
        group = {
            "uuid": self._uuid("group", 0),
            "type": "Group",
            "matrix": matrix.T.ravel().tolist(),
            "children": children,
        }
        return {"metadata": {"version": 4.5, "type": "Object"}, **self._lists, "object": group}

    def _add(self, name: str, item: dict[str, Any]) -> str:
        items = self._lists[name]
        for known in items:
            if name == "materials" and {**known, "uuid": ""} == {**item, "uuid": ""}:
                return str(known["uuid"])
        identifier = self._uuid(name, len(items))
        items.append({"uuid": identifier, **item})
        return identifier

    def _uuid(self, kind: str, number: int) -> str:
        return str(uuid.uuid5(uuid.NAMESPACE_URL, f"{self._path}#{kind}{number}"))


def _linear(colors: np.ndarray) -> np.ndarray:
    """Return sRGB colors from 0 to 1 as linear ones, as three.js takes those of vertices."""
    return np.asarray(np.where(colors <= 0.04045, colors / 12.92, ((np.maximum(colors, 0.0) + 0.055) / 1.055) ** 2.4))


def _array(values: np.ndarray, kind: tuple[str, int]) -> dict[str, Any]:
    name, code = kind
    data = np.ascontiguousarray(values, dtype=np.float32 if kind is _FLOAT32 else np.uint32)
    return {
        "itemSize": data.shape[1],
        "type": name,
        "array": umsgpack.Ext(code, data.tobytes()),
        "normalized": False,
    }
