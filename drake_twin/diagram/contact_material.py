"""How stiff shapes are, how they damp, and the meshes that Drake makes of them for contact."""

from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise

import numpy as np
from pydrake.common import MemoryFile
from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    AddContactMaterial,
    AddRigidHydroelasticProperties,
    Box,
    Convex,
    Cylinder,
    HalfSpace,
    InMemoryMesh,
    Mesh,
    ProximityProperties,
    Shape,
)
from pydrake.multibody.plant import CoulombFriction

from drake_twin.description.hull import without_slivers
from drake_twin.diagram.contact_shapes import ContactShape

# A face yields as if the thing that it belongs to stood on a spring of this natural frequency, squared (1/s²): whatever
# its size and mass, it sinks by g / this = 25 µm under its own weight. With 2e5 a stack of three on a slope of 12°
# leans by 4 mm, with 1e5 it falls. With more, at a step of 10 ms, what slides on something that moves trembles, which
# brakes it: 1e6 by up to 6 % at a friction of 0.8, 4e5 by 2 %. With 1.6e7 stacks of light crates wander.
_FACE_STIFFNESS = 4e5

# The same for shapes that touch in a point.
_POINT_STIFFNESS = 1e5
_RIGID = 1e12  # N/m; a point of what does not move

# Hunt and Crossley's dissipation (s/m). What has sunk in comes out at 1/this at most: Drake's default of 50 lets it
# creep, 1 lets it jump.
_DISSIPATION = 5.0

# Faces nearer to each other than this take part in the solution of a step before they touch (m), so that a step does
# not let them sink into each other. Without it, at a step of 10 ms, a box that is set down sticks where it should
# slide: friction follows from the depth at the start of a step.
_MARGIN = 1e-3
_MARGIN_OF_THIN = 0.05  # of the smallest side

_SQUARES = 4  # along a side of a box that is a fine mesh
_THINNEST = 1e-6  # m
_LEAST_AREA = 1e-9  # m²; with a tenth of that, Drake says that it cannot make a plane


def candidates(
    shape: ContactShape, friction: float, *, is_soft: bool, is_rigid: bool
) -> Iterator[tuple[bool, ProximityProperties]]:
    """What a shape's properties can be, the best first; whether each has faces. The last is what Drake always takes.

    Args:
        shape: the shape.
        friction: the coefficient of friction.
        is_soft: whether its faces yield.
        is_rigid: whether it has faces that do not.
    """
    if is_soft:
        modulus, hint = _modulus(shape), _resolution(shape.shape)
        for margin in dict.fromkeys((_margin(shape.shape), 0.0)):
            properties = _material(shape, friction)
            AddCompliantHydroelasticProperties(
                resolution_hint=hint, hydroelastic_modulus=modulus, properties=properties
            )
            properties.AddProperty("hydroelastic", "margin", margin)
            yield True, properties
    elif is_rigid:
        properties = _material(shape, friction)
        AddRigidHydroelasticProperties(resolution_hint=_resolution(shape.shape), properties=properties)
        yield True, properties
    yield False, _material(shape, friction)


def _material(shape: ContactShape, friction: float) -> ProximityProperties:
    properties = ProximityProperties()
    AddContactMaterial(
        dissipation=_DISSIPATION,
        point_stiffness=_RIGID if shape.is_static else _POINT_STIFFNESS * shape.mass,
        friction=CoulombFriction(friction, friction),
        properties=properties,
    )
    return properties


def yielding(shape: ContactShape) -> Shape:
    """The shape whose faces yield: a box that lies or slides as a whole is a fine mesh of itself.

    Drake puts one force on each facet where two shapes meet. Of a `Box` those are few: three crates on a slope of 12°
    fall over, and creep, for the solver's regularization of friction is divided among the facets.
    """
    if isinstance(shape.shape, Convex):
        return _sound_hull(shape.shape)
    if not shape.is_loose or not isinstance(shape.shape, Box):
        return shape.shape
    x, y, z = shape.shape.size().tolist()
    return Mesh(InMemoryMesh(mesh_file=MemoryFile(_fine_box(x, y, z), ".vtk", "box")))


def _sound_hull(shape: Convex) -> Shape:
    """A hull without the slivers that would end the simulation when they touch something."""
    source, scale = shape.source(), tuple(shape.scale3().tolist())
    corners = _sound_corners(str(source.path()), scale) if source.is_path() else _sound(shape)
    return shape if corners is None else Convex(corners, "hull")


@lru_cache(maxsize=1024)
def _sound_corners(path: str, scale: tuple[float, ...]) -> np.ndarray | None:
    return _sound(Convex(path, np.array(scale)))


def _sound(shape: Convex) -> np.ndarray | None:
    """The corners (3×n, m) of a hull without slivers; None where it has none."""
    hull = shape.GetConvexHull()
    points = np.array([hull.vertex(index) for index in range(hull.num_vertices())])
    corners = without_slivers(points, _LEAST_AREA)
    return None if len(corners) == len(points) else np.ascontiguousarray(corners.T)


@lru_cache(maxsize=64)
def _fine_box(x: float, y: float, z: float) -> str:
    """A box as tetrahedra between its center and squares on its sides, as VTK text."""
    points: dict[tuple[float, ...], int] = {}
    triangles = []
    cuts = np.linspace(-0.5, 0.5, _SQUARES + 1).tolist()
    for axis in range(3):
        for side in (-0.5, 0.5):
            for i, (left, right) in enumerate(pairwise(cuts)):
                for j, (low, high) in enumerate(pairwise(cuts)):
                    corners = []
                    for across in ((left, low), (right, low), (right, high), (left, high)):
                        point = np.roll((side, *across), axis) * (x, y, z)
                        corners.append(points.setdefault(tuple(point.tolist()), len(points)))
                    a, b, c, d = corners if side < 0 else corners[::-1]  # seen from the center, counterclockwise
                    triangles += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(b, c, d), (b, d, a)]
    center = len(points)
    lines = ["# vtk DataFile Version 3.0", "box", "ASCII", "DATASET UNSTRUCTURED_GRID"]
    lines += [f"POINTS {center + 1} double", *(" ".join(map(repr, point)) for point in points), "0 0 0"]
    lines += [f"CELLS {len(triangles)} {5 * len(triangles)}"]
    lines += [f"4 {a} {b} {c} {center}" for a, b, c in triangles]
    return "\n".join([*lines, f"CELL_TYPES {len(triangles)}", *["10"] * len(triangles), ""])


def _margin(shape: Shape) -> float:
    if isinstance(shape, Convex):  # Drake takes 0.15 ms a corner for it, and fails where corners are near
        return 0.0
    return min(_MARGIN, _MARGIN_OF_THIN * float(min(_extent(shape))))


def _modulus(shape: ContactShape) -> float:
    """The modulus with which a shape's largest face is a spring of `_FACE_STIFFNESS` (Pa).

    In Drake's pressure field the pressure rises from a face to half the smallest depth below it.
    """
    smallest, middle, largest = sorted(_extent(shape.shape))
    return float(_FACE_STIFFNESS * shape.mass * smallest / 2 / (middle * largest))


def _resolution(shape: Shape) -> float:
    """How long the edges of a cylinder's facets are (m); boxes and hulls have their own."""
    return shape.radius() / 3 if isinstance(shape, Cylinder) else 1.0


def _extent(shape: Shape) -> np.ndarray:
    """The sides of a shape's bounding box (m)."""
    assert not isinstance(shape, HalfSpace)
    if isinstance(shape, Box):
        return np.array(shape.size())
    if isinstance(shape, Cylinder):
        return np.array([2 * shape.radius(), 2 * shape.radius(), shape.length()])
    hull = shape.GetConvexHull()
    points = np.array([hull.vertex(index) for index in range(hull.num_vertices())])
    return np.asarray(np.maximum(np.ptp(points, axis=0), _THINNEST))
