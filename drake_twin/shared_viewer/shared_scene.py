"""What a viewer outside this process draws of a twin: its bodies' illustration geometry, and their poses."""

import weakref
from collections.abc import Container
from itertools import count
from typing import Any

import numpy as np
from pydrake.geometry import FrameId, HalfSpace, Rgba, Role, SceneGraph, Shape
from pydrake.math import RigidTransform

from drake_twin.dataclass import dataclass
from drake_twin.twin.twin import Twin

WORLD = "world"  # the folder of fixed geometry

_DEFAULT_COLOR = Rgba(0.9, 0.9, 0.9, 1.0)
_GROUND_COLOR = Rgba(0.8, 0.81, 0.82, 1.0)
_BELOW_THE_GRID = 0.004  # m: viewers draw a grid at z = 0


@dataclass(frozen=True)
class DrawnGeometry:
    """A geometry on a body.

    Attributes:
        path: Body and geometry, for example ``robot_1/base_link/body``.
        shape: Drake's shape, a copy that does not keep the scene graph alive.
        color: Red, green, blue and opacity from 0 to 1; a mesh's own materials have precedence.
        X_BG: The geometry's pose in the body's frame, as a 4x4 matrix.
    """

    path: str
    shape: Shape
    color: tuple[float, float, float, float]
    X_BG: np.ndarray


class SharedScene:
    """The geometry of a twin's bodies, read once, and their poses, read each frame.

    Attributes:
        geometries: The geometries to draw.
        bodies: The paths of the bodies that may move, in the order of `poses`.
        body_paths: Index of such a body in the plant → its path.

    Args:
        twin: The twin. Neither the twin nor its diagram is kept alive.
    """

    def __init__(self, twin: Twin):
        self._diagram = weakref.ref(twin.diagram)
        inspector = scene_graph_of(twin).model_inspector()
        world = inspector.world_frame_id()
        bodies: dict[FrameId, str] = {}
        geometries: dict[str, DrawnGeometry] = {}
        for geometry in inspector.GetAllGeometryIds(Role.kIllustration):
            if inspector.IsDeformableGeometry(geometry):
                continue
            frame = inspector.GetFrameId(geometry)
            body = WORLD if frame == world else body_path(inspector.GetName(frame))
            if frame != world:
                bodies[frame] = body
            name = inspector.GetName(geometry).rpartition("::")[2].replace("/", "_")
            properties = inspector.GetIllustrationProperties(geometry)
            color = properties.GetPropertyOrDefault("phong", "diffuse", _DEFAULT_COLOR)
            path = _unused(f"{body}/{name}", geometries)
            geometries[path] = DrawnGeometry(
                path=path,
                shape=inspector.GetShape(geometry).Clone(),
                color=(color.r(), color.g(), color.b(), color.a()),
                X_BG=inspector.GetPoseInFrame(geometry).GetAsMatrix4(),
            )
        if twin.scenario.world.has_own_ground:
            path = _unused(f"{WORLD}/ground", geometries)
            geometries[path] = _ground(path, place_of_robots(twin)[0])
        plant = twin.plant
        self._indices = [int(plant.GetBodyFromFrameId(frame).index()) for frame in bodies]
        self.bodies = tuple(bodies.values())
        self.body_paths = dict(zip(self._indices, self.bodies, strict=True))
        self.geometries = tuple(geometries.values())

    def shows(self, twin: Twin) -> bool:
        """Return whether this is still the twin's scene; it is not after a robot was added or deleted."""
        return self._diagram() is twin.diagram

    def poses(self, twin: Twin) -> np.ndarray:
        """Return the present poses of the bodies in the world as 4x4 matrices, shape (bodies, 4, 4)."""
        plant = twin.plant
        poses = plant.get_body_poses_output_port().Eval(plant.GetMyContextFromRoot(twin.context))
        found = np.zeros((len(self._indices), 4, 4))
        found[:, 3, 3] = 1.0
        if self._indices:
            found[:, :3] = [poses[index].GetAsMatrix34() for index in self._indices]
        return found


def scene_graph_of(twin: Twin) -> SceneGraph:
    """Return the scene graph of a twin's diagram."""
    scene_graph: Any = twin.diagram.GetSubsystemByName("scene_graph")
    return scene_graph


def body_path(frame: str) -> str:
    """Return the path of a body, ``model/body``, given its name ``model::body``.

    It has two levels only, so that no body's path is below another's and moves with it.
    """
    model, _, body = frame.replace("/", "_").rpartition("::")
    return f"{model.replace('::', '.') or WORLD}/{body}"


def _unused(path: str, taken: Container[str]) -> str:
    numbered = (f"{path}_{number}" for number in count(2))
    return path if path not in taken else next(other for other in numbered if other not in taken)


def place_of_robots(twin: Twin) -> tuple[np.ndarray, float]:
    """Return the center of all robots (x, y, z in the world, m), and their largest distance from it plus 1 m."""
    positions = np.array([twin.robot_state(robot).base_pose[:3] for robot in twin.robots]).reshape(-1, 3)
    if not len(positions):
        return np.zeros(3), 1.0
    center = positions.mean(axis=0)
    return center, float(np.max(np.linalg.norm(positions - center, axis=1))) + 1.0


def _ground(path: str, center: np.ndarray) -> DrawnGeometry:
    """Return a ground for a world whose own has no illustration geometry."""
    color = (_GROUND_COLOR.r(), _GROUND_COLOR.g(), _GROUND_COLOR.b(), _GROUND_COLOR.a())
    pose = RigidTransform([*np.round(center[:2]), -_BELOW_THE_GRID])
    return DrawnGeometry(path, HalfSpace(), color, pose.GetAsMatrix4())
