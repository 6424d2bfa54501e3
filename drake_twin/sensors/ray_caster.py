"""What rays meet first among the shapes of a scene graph; nothing else knows Embree.

What does not move is one scene of triangles in the world's axes. Each moving body is a small scene in its own axes:
rays are turned into them, and only those that meet the body's bounding sphere. Round shapes and half spaces have no
triangles: they are met by formula.
"""

from collections.abc import Sequence
from dataclasses import field
from functools import cache, cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.geometry import Box, Convex, GeometryId, HalfSpace, Mesh, Role, SceneGraphInspector, Shape
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant

from drake_twin.dataclass import dataclass
from drake_twin.description.hull import corners_of
from drake_twin.description.mesh_triangles import hulled_triangles, mesh_triangles, named_hull
from drake_twin.errors import InputError
from drake_twin.requirements import missing
from drake_twin.sensors.round_shapes import ROUND_SHAPES, distances, radius_of, sizes_of

_BLOCK = 1024  # rays at a time, which fit into the processor's cache
_UNSEEN = ("/friction/", "|corner")  # in the names of shapes that brake joints, or that are parts of other shapes
_STEP = 1e-5  # so far behind the back of a triangle a ray begins again (m, and relative to its way)
_EDGE_ON = 1e-6  # the sine of the angle below which a triangle is not seen; the ray passes it by a step
_TINY = 1e-30
_MARGIN = 1e-5  # of a bounding sphere's radius and distance, for rounding


@dataclass(frozen=True)
class _Balls:
    """Round shapes of one kind: centers, turns, radii of the spheres about them, and their `sizes_of`, one a row."""

    centers: np.ndarray
    turns: np.ndarray
    radii: np.ndarray
    sizes: np.ndarray


@dataclass
class _Group:
    """Shapes that do not move relative to each other, in the axes of their body.

    Attributes:
        body: The body's index in the plant; None for what does not move.
        triangles: Vertices and faces of each shape.
        round: Round shapes with their poses.
        planes: Half spaces with their poses.
        from_inside: Whether rays meet a shape from inside, too.
    """

    body: int | None
    from_inside: bool
    triangles: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)
    round: list[tuple[Shape, RigidTransform]] = field(default_factory=list)
    planes: list[RigidTransform] = field(default_factory=list)

    @cached_property
    def scene(self) -> Any:
        """The triangles in Embree; None without any."""
        if not self.triangles:
            return None
        rtcore_scene, mesh_construction = _embree()
        scene = rtcore_scene.EmbreeScene(_device())
        counts = np.cumsum([0, *(len(vertices) for vertices, _ in self.triangles)])
        vertices = np.vstack([vertices for vertices, _ in self.triangles])
        faces = np.vstack([faces + count for (_, faces), count in zip(self.triangles, counts, strict=False)])
        mesh_construction.TriangleMesh(scene, vertices.astype(np.float32), faces.astype(np.int32))
        return scene

    @cached_property
    def kinds(self) -> tuple[tuple[type[Shape], _Balls], ...]:
        """The round shapes of each kind."""
        found: dict[type[Shape], list[tuple[Shape, RigidTransform]]] = {}
        for shape, pose in self.round:
            found.setdefault(next(kind for kind in ROUND_SHAPES if isinstance(shape, kind)), []).append((shape, pose))
        return tuple(
            (
                kind,
                _Balls(
                    centers=np.array([pose.translation() for _, pose in items]),
                    turns=np.array([pose.rotation().matrix() for _, pose in items]),
                    radii=np.array([radius_of(shape) for shape, _ in items]),
                    sizes=np.array([sizes_of(shape) for shape, _ in items]),
                ),
            )
            for kind, items in found.items()
        )

    @cached_property
    def sphere(self) -> tuple[np.ndarray, float]:
        """Center and radius of a sphere about all shapes but the half spaces."""
        corners = [vertices for vertices, _ in self.triangles]
        corners += [
            pose.translation() + radius_of(shape) * np.vstack([np.eye(3), -np.eye(3)]) for shape, pose in self.round
        ]
        points = np.vstack(corners)
        center = (points.min(axis=0) + points.max(axis=0)) / 2
        reach = [np.linalg.norm(vertices - center, axis=1).max() for vertices, _ in self.triangles]
        reach += [np.linalg.norm(pose.translation() - center) + radius_of(shape) for shape, pose in self.round]
        return center, float(max(reach))

    def cast(self, origin: np.ndarray, directions: np.ndarray, nearest: float, farthest: float) -> np.ndarray:
        """Return how far away rays meet the shapes, in the group's axes; see `RayCaster.cast`."""
        found = np.full(len(directions), np.inf)
        if self.scene is not None:
            found = self._cast_into_triangles(origin, directions, nearest)
        for kind, balls in self.kinds:
            shapes, rays = _meets(directions, balls.centers - origin, balls.radii, nearest, farthest)
            turns = balls.turns[shapes]
            starts = np.einsum("ij,ijk->ik", origin - balls.centers[shapes], turns)
            ways = np.einsum("ij,ijk->ik", directions[rays], turns)
            np.minimum.at(
                found, rays, distances(kind, balls.sizes[shapes], starts, ways, nearest, from_inside=self.from_inside)
            )
        for pose in self.planes:
            normal = pose.rotation().matrix()[:, 2]
            with np.errstate(divide="ignore", invalid="ignore"):
                ways = (normal @ (pose.translation() - origin)) / (directions @ normal)
            seen = (ways >= nearest) & (self.from_inside | (directions @ normal < 0.0))
            found = np.minimum(found, np.where(seen, ways, np.inf))
        return found

    def _cast_into_triangles(self, origin: np.ndarray, directions: np.ndarray, nearest: float) -> np.ndarray:
        found = np.full(len(directions), np.inf)
        rays, begins = np.arange(len(directions)), np.full(len(directions), nearest)
        ways, aside = directions.astype(np.float32), np.zeros((len(directions), 3))
        while len(rays):
            starts = (origin + aside + begins[:, np.newaxis] * directions[rays]).astype(np.float32)
            farthest = np.full(len(rays), 1e37, dtype=np.float32)
            if self.from_inside:
                far = self.scene.run(starts, ways[rays], query="DISTANCE", dists=farthest).astype(float)
                return np.where(far < 1e30, far + nearest, np.inf)
            met = self.scene.run(starts, ways[rays], output=1, dists=farthest)
            far, normals = begins + met["tfar"].astype(float), met["Ng"].astype(float)
            is_met = met["primID"] >= 0
            normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), _TINY)
            slopes = np.einsum("ij,ij->i", normals, directions[rays])
            is_front = is_met & (slopes < -_EDGE_ON)
            found[rays[is_front]] = far[is_front]
            again = is_met & ~is_front
            aside += np.where((again & (np.abs(slopes) <= _EDGE_ON))[:, np.newaxis], _STEP * normals, 0.0)
            rays, begins, aside = rays[again], far[again] * (1.0 + _STEP) + _STEP, aside[again]
        return found


class RayCaster:
    """Casts rays from one point into a scene.

    Args:
        plant: The finalized plant whose bodies have the shapes.
        inspector: The scene graph's.
        role: Which shapes are seen: ``Role.kIllustration`` or ``Role.kProximity``. Of what is drawn the backs are not
            seen, as in Gazebo's renderer, so that a lidar sees out of its housing.

    Raises:
        InputError: If Embree is not installed.
    """

    def __init__(self, plant: MultibodyPlant, inspector: SceneGraphInspector, role: Role):
        _embree()
        fixed = {int(body.index()) for body in plant.GetBodiesWeldedTo(plant.world_body())}
        start = plant.CreateDefaultContext()
        from_inside = role is Role.kProximity
        self._static = _Group(None, from_inside)
        meshes: dict[tuple[str, ...], tuple[np.ndarray, np.ndarray]] = {}
        self._moving: list[_Group] = []
        for frame in inspector.GetAllFrameIds():
            body = plant.GetBodyFromFrameId(frame)
            geometries = [
                item
                for item in inspector.GetGeometries(frame, role)
                if not any(part in inspector.GetName(item) for part in _UNSEEN)
            ]
            if body is None or not geometries:
                continue
            index = int(body.index())
            if index in fixed:
                group, pose = self._static, plant.EvalBodyPoseInWorld(start, body)
            else:
                group, pose = _Group(index, from_inside), RigidTransform()
                self._moving.append(group)
            for geometry in geometries:
                _add(group, inspector, geometry, pose, meshes)
        if role is not Role.kProximity:  # the ground is seen, whether or not it is drawn
            for geometry in inspector.GetGeometries(inspector.world_frame_id(), Role.kProximity):
                if isinstance(inspector.GetShape(geometry), HalfSpace):
                    _add(self._static, inspector, geometry, RigidTransform(), meshes)

    def cast(
        self,
        poses: Sequence[RigidTransform],
        origin: np.ndarray,
        directions: np.ndarray,
        nearest: float = 0.0,
        farthest: float = np.inf,
    ) -> np.ndarray:
        """Return how far away each ray first meets a shape (m); infinite where it meets none.

        Args:
            poses: The pose of each body in the world, by its index.
            origin: Where all rays begin, in the world (m).
            directions: Unit vectors in the world, one a row.
            nearest: Shapes that are nearer are not seen (m).
            farthest: Shapes that are farther away need not be seen (m).
        """
        found = self._static.cast(origin, directions, nearest, farthest)
        if not self._moving:
            return found
        matrices = np.array([poses[group.body or 0].GetAsMatrix34() for group in self._moving])
        turns, positions = matrices[:, :, :3], matrices[:, :, 3]
        centers, radii = self._spheres
        ways = positions + np.einsum("bij,bj->bi", turns, centers) - origin
        groups, rays_met = _meets(directions, ways, radii, nearest, farthest)
        for index in np.unique(groups):
            rays, turn = rays_met[groups == index], turns[index]
            start = (origin - positions[index]) @ turn
            met = self._moving[index].cast(start, directions[rays] @ turn, nearest, farthest)
            found[rays] = np.minimum(found[rays], met)
        return found

    @cached_property
    def _spheres(self) -> tuple[np.ndarray, np.ndarray]:
        """The bounding spheres of the moving bodies: their centers, one a row, and their radii."""
        centers, radii = zip(*(group.sphere for group in self._moving), strict=True)
        return np.array(centers), np.array(radii)


def _meets(
    directions: np.ndarray, ways: np.ndarray, radii: np.ndarray, nearest: float, farthest: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the pairs of spheres and rays that may meet: the indices of the spheres, in order, and of the rays.

    Args:
        directions: Unit vectors, one a row.
        ways: The ways from the rays' origin to the spheres' centers, one a row (m).
        radii: Of the spheres (m).
        nearest: Spheres that are nearer as a whole are left out (m).
        farthest: Spheres that are farther away are left out (m).
    """
    squares = np.einsum("bi,bi->b", ways, ways)
    lengths = np.sqrt(squares)
    there = np.flatnonzero((lengths - radii <= farthest) & ((1.0 + _MARGIN) * (lengths + radii) >= nearest))
    ways, radii, squares = ways[there], radii[there], squares[there][:, np.newaxis]
    reach = (radii + _MARGIN * (radii + np.sqrt(squares[:, 0])))[:, np.newaxis] ** 2
    found = np.empty((len(ways), len(directions)), dtype=bool)
    for begin in range(0, len(directions), _BLOCK):
        along = ways @ directions[begin : begin + _BLOCK].T
        near = squares - along**2 <= reach
        near &= along > 0.0
        found[:, begin : begin + _BLOCK] = near
    found |= squares <= reach
    rows, rays = np.nonzero(found)
    return there[rows], rays


def _add(
    group: _Group,
    inspector: SceneGraphInspector,
    geometry: GeometryId,
    pose: RigidTransform,
    meshes: dict[tuple[str, ...], tuple[np.ndarray, np.ndarray]],
) -> None:
    """Add a shape to a group; files are read once."""
    shape, X_BG = inspector.GetShape(geometry), pose @ inspector.GetPoseInFrame(geometry)
    if isinstance(shape, HalfSpace):
        group.planes.append(X_BG)
    elif isinstance(shape, ROUND_SHAPES):
        group.round.append((shape, X_BG))
    else:
        vertices, faces = _triangles(shape, meshes)
        group.triangles.append((vertices @ X_BG.rotation().matrix().T + X_BG.translation(), faces))


def _triangles(
    shape: Shape, meshes: dict[tuple[str, ...], tuple[np.ndarray, np.ndarray]]
) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and faces of a box, a mesh or a convex hull, in its frame."""
    if isinstance(shape, Box):
        corners = np.array(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [-0.5, 0.5], indexing="ij")).reshape(3, 8).T
        quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
        faces = [half for a, b, c, d in quads for half in ((a, b, c), (a, c, d))]
        return corners * shape.size(), np.array(faces)
    if isinstance(shape, Mesh | Convex) and (read := _file_of(shape)) is not None:
        file, scale, is_whole = read
        key = (str(file), *map(str, scale), str(is_whole))
        if key not in meshes:
            found = hulled_triangles(file)
            if found is None and is_whole:
                found = mesh_triangles(file)
            if found is not None:
                meshes[key] = found[0] * scale, found[1] if scale.prod() > 0 else found[1][:, ::-1]
        if key in meshes:
            return meshes[key]
    if isinstance(shape, Mesh | Convex):
        hull = shape.GetConvexHull()
        faces = []
        for index in range(hull.num_elements()):
            face = hull.element(index)
            around = [face.vertex(corner) for corner in range(face.num_vertices())]
            faces += [(around[0], b, c) for b, c in pairwise(around[1:])]
        return corners_of(hull), np.array(faces)
    raise InputError(f"a lidar cannot see a {type(shape).__name__}")


def _file_of(shape: Mesh | Convex) -> tuple[Path, np.ndarray, bool] | None:
    """Return a shape's file, its scale and whether the shape is all that is in it; None for one in memory.

    What contact makes of a robot's mesh, its hull, stands for the whole mesh: as that Gazebo's rays meet it.
    """
    source = shape.source()
    if source.is_path():
        is_whole = isinstance(shape, Mesh) and shape.extension() in (".obj", ".gltf", ".glb")
        return Path(source.path()), np.array(shape.scale3()), is_whole
    named = named_hull(source.in_memory().mesh_file.filename_hint())
    return None if named is None else (*named, False)


@cache
def _device() -> Any:
    """Return what all scenes share."""
    from embreex.rtcore import EmbreeDevice

    return EmbreeDevice()


def _embree() -> tuple[Any, Any]:
    try:
        from embreex import mesh_construction, rtcore_scene
    except ImportError as error:
        raise missing("lidars need", "embreex") from error
    return rtcore_scene, mesh_construction
