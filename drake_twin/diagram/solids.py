"""The volumes of links: their collision shapes as files have them, before contact gives them other shapes."""

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path

import numpy as np
from pydrake.geometry import (
    Box,
    Capsule,
    Convex,
    Cylinder,
    Ellipsoid,
    Mesh,
    Role,
    SceneGraph,
    Shape,
    Sphere,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex

from drake_twin.control.submerged import (
    Solid,
    box_triangles,
    capsule_triangles,
    cylinder,
    ellipsoid,
    is_closed,
    surface,
)
from drake_twin.description.coarse_mesh import merged
from drake_twin.description.hull import corners_of
from drake_twin.description.mesh_triangles import hulled_triangles


def solids_of(plant: MultibodyPlant, scene_graph: SceneGraph) -> Mapping[BodyIndex, tuple[Solid, ...]]:
    """Return the collision shapes of a plant's bodies that have a volume.

    Args:
        plant: The plant, before `drake_twin.diagram.contact.give_contact`.
        scene_graph: Its scene graph.
    """
    inspector = scene_graph.model_inspector()
    found: dict[BodyIndex, tuple[Solid, ...]] = {}
    for geometry in inspector.GetAllGeometryIds(Role.kProximity):
        body = plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
        if body is None or body.index() == plant.world_body().index():
            continue
        solid = solid_of(inspector.GetShape(geometry), inspector.GetPoseInFrame(geometry))
        if solid is not None:
            found[body.index()] = (*found.get(body.index(), ()), solid)
    return found


def solid_of(shape: Shape, X_BG: RigidTransform) -> Solid | None:
    """Return a shape as a solid in the frame of its body; None for one without a volume."""
    R, center = X_BG.rotation().matrix(), X_BG.translation()
    if isinstance(shape, Sphere):
        return ellipsoid([shape.radius()] * 3, R, center)
    if isinstance(shape, Ellipsoid):
        return ellipsoid([shape.a(), shape.b(), shape.c()], R, center)
    if isinstance(shape, Cylinder):
        return cylinder(shape.radius(), shape.length(), R, center)
    if isinstance(shape, Box):
        triangles = box_triangles(shape.size())
    elif isinstance(shape, Capsule):
        triangles = capsule_triangles(shape.radius(), shape.length())
    elif isinstance(shape, Mesh | Convex):
        triangles = _mesh_triangles(shape)
    else:
        return None
    return surface(triangles @ R.T + center)


def _mesh_triangles(shape: Mesh | Convex) -> np.ndarray:
    """Return the triangles of the mesh in a file, or of its hull where they do not enclose anything."""
    source = shape.source()
    found = hulled_triangles(Path(source.path())) if source.is_path() else None
    if found is not None:
        vertices, faces = merged(*found)
        if len(faces) and is_closed(vertices, faces):
            found_triangles: np.ndarray = vertices[faces] * shape.scale3()
            return found_triangles
    hull = shape.GetConvexHull()
    triangles = []
    for index in range(hull.num_elements()):
        face = hull.element(index)
        first, *others = (face.vertex(corner) for corner in range(face.num_vertices()))
        triangles += [(first, b, c) for b, c in pairwise(others)]
    corners: np.ndarray = corners_of(hull)[np.array(triangles)]
    return corners
