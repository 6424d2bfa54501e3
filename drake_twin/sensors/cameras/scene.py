"""What cameras see, as plain data that another process can draw."""

from collections.abc import Iterator, Sequence

import numpy as np
from pydrake.geometry import (
    Box,
    Capsule,
    Convex,
    Cylinder,
    Ellipsoid,
    GeometryId,
    HalfSpace,
    Mesh,
    Rgba,
    Role,
    SceneGraphInspector,
    Shape,
    Sphere,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant

from drake_twin.dataclass import dataclass
from drake_twin.description.hull import corners_of
from drake_twin.description.surroundings import Light, Surroundings

_ENDLESS = 5000.0  # m: a box that is as wide stands in for the ground, see `drake_twin.diagram.static_world`
_GROUND = (0.74, 0.77, 0.74, 1.0)
_BRAKE = "/friction/"  # in the names of the shapes that brake joints, which nobody sees


@dataclass(frozen=True)
class SeenShape:
    """A shape on a body.

    Attributes:
        kind: ``box``, ``sphere``, ``cylinder``, ``capsule``, ``ellipsoid``, ``plane``, ``mesh`` or ``hull``.
        sizes: What Drake's shape of this kind takes: sides, radius and length; scales of a mesh; points of a hull.
        file: The file of a mesh; empty for other shapes.
        texture: A picture on it; empty without one.
        color: Red, green, blue and opacity (0 to 1); empty where the file has none, so that a mesh has its own.
        moves: The place of its body in `SeenScene.bodies`; None if it does not move.
        pose: Its pose in the body, or in the world if it does not move: a matrix (3, 4), row by row.
        label: What label pictures call it: the body's index in the plant and one; 0 for what belongs to no body.
    """

    kind: str
    sizes: tuple[float, ...]
    file: str
    texture: str
    color: tuple[float, ...]
    moves: int | None
    pose: tuple[float, ...]
    label: int


@dataclass(frozen=True)
class SeenScene:
    """All that cameras see.

    Attributes:
        shapes: The shapes.
        bodies: The indices in the plant of the bodies that move.
        lights: The lights of the world.
        background: The color of the sky (0 to 1).
    """

    shapes: tuple[SeenShape, ...]
    bodies: tuple[int, ...]
    lights: tuple[Light, ...] = ()
    background: tuple[float, float, float] = (0.7, 0.7, 0.7)

    def poses(self, poses: Sequence[RigidTransform]) -> np.ndarray:
        """Return the poses of the bodies that move, (bodies, 3, 4), given those of all bodies of the plant."""
        return np.array([poses[index].GetAsMatrix34() for index in self.bodies]).reshape(-1, 3, 4)


def seen_scene(plant: MultibodyPlant, inspector: SceneGraphInspector, surroundings: Surroundings) -> SeenScene:
    """Return the visual shapes of a plant's bodies, and the ground where the world's file draws none.

    Args:
        plant: The finalized plant.
        inspector: The scene graph's.
        surroundings: The lights and the sky of the world.
    """
    fixed = {int(body.index()) for body in plant.GetBodiesWeldedTo(plant.world_body())}
    start = plant.CreateDefaultContext()
    bodies: list[int] = []
    shapes: list[SeenShape] = []
    for frame in inspector.GetAllFrameIds():
        body = plant.GetBodyFromFrameId(frame)
        geometries = [
            item for item in inspector.GetGeometries(frame, Role.kIllustration) if _BRAKE not in inspector.GetName(item)
        ]
        if body is None or not geometries:
            continue
        index, moves, pose = int(body.index()), None, RigidTransform()
        if index in fixed:
            pose = plant.EvalBodyPoseInWorld(start, body)
        else:
            moves = len(bodies)
            bodies.append(index)
        for geometry in geometries:
            shapes += _seen(inspector, geometry, pose, moves, index)
    if not any(shape.kind == "plane" for shape in shapes):
        shapes += _undrawn_ground(inspector)
    return SeenScene(tuple(shapes), tuple(bodies), surroundings.lights, surroundings.background)


def _undrawn_ground(inspector: SceneGraphInspector) -> Iterator[SeenShape]:
    """Yield the planes on which robots stand: half spaces, or the upper sides of boxes that stand in for them."""
    for geometry in inspector.GetGeometries(inspector.world_frame_id(), Role.kProximity):
        shape, X_WG = inspector.GetShape(geometry), inspector.GetPoseInFrame(geometry)
        if isinstance(shape, Box) and min(shape.width(), shape.depth()) >= _ENDLESS:
            X_WG = X_WG @ RigidTransform([0.0, 0.0, shape.height() / 2])
        elif not isinstance(shape, HalfSpace):
            continue
        yield SeenShape("plane", (), "", "", _GROUND, None, tuple(X_WG.GetAsMatrix34().ravel().tolist()), 1)


def _seen(
    inspector: SceneGraphInspector, geometry: GeometryId, pose: RigidTransform, moves: int | None, body: int
) -> Iterator[SeenShape]:
    found = _plain(inspector.GetShape(geometry))
    if found is None:
        return
    kind, sizes, file = found
    properties = inspector.GetIllustrationProperties(geometry)
    color: tuple[float, ...] = ()
    texture = ""
    if properties.HasProperty("phong", "diffuse"):
        rgba: Rgba = properties.GetProperty("phong", "diffuse")
        color = (rgba.r(), rgba.g(), rgba.b(), rgba.a())
    if properties.HasProperty("phong", "diffuse_map"):
        texture = str(properties.GetProperty("phong", "diffuse_map"))
    X = (pose @ inspector.GetPoseInFrame(geometry)).GetAsMatrix34()
    yield SeenShape(kind, sizes, file, texture, color, moves, tuple(X.ravel().tolist()), body + 1)


def _plain(shape: Shape) -> tuple[str, tuple[float, ...], str] | None:
    """Return a shape's kind, sizes and file; None for one that nothing can draw."""
    if isinstance(shape, Box):
        return "box", tuple(map(float, shape.size())), ""
    if isinstance(shape, Sphere):
        return "sphere", (shape.radius(),), ""
    if isinstance(shape, Cylinder):
        return "cylinder", (shape.radius(), shape.length()), ""
    if isinstance(shape, Capsule):
        return "capsule", (shape.radius(), shape.length()), ""
    if isinstance(shape, Ellipsoid):
        return "ellipsoid", (shape.a(), shape.b(), shape.c()), ""
    if isinstance(shape, HalfSpace):
        return "plane", (), ""
    if isinstance(shape, Mesh) and shape.source().is_path():
        return "mesh", tuple(map(float, shape.scale3())), str(shape.source().path())
    if isinstance(shape, Mesh | Convex):
        return "hull", tuple(corners_of(shape.GetConvexHull()).ravel().tolist()), ""
    return None
