"""Draws the pictures of a film: robots and world by Drake's renderer, shadows by what the sun sees, ground and sky."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates

from drake_twin.dataclass import dataclass
from drake_twin.description.surroundings import Light
from drake_twin.film.camera import Camera, Shot, looking_along
from drake_twin.film.surroundings import Backdrop, backdrop, rays
from drake_twin.sensors.cameras.picture import COLOR, DEPTH, View
from drake_twin.sensors.cameras.render_process import Painter
from drake_twin.sensors.cameras.scene import SeenScene, SeenShape

_TO_SUN = np.array([0.15, -0.75, 0.9]) / np.linalg.norm([0.15, -0.75, 0.9])  # from the camera's left, in the world
_LIGHTS = (
    Light(direction=tuple((-_TO_SUN).tolist()), color=(1.0, 0.98, 0.95), intensity=0.62, casts_shadows=False),
    Light(direction=(-0.6, 0.75, -0.35), color=(0.95, 0.97, 1.0), intensity=0.16, casts_shadows=False),
    Light(direction=(0.0, 0.0, -1.0), color=(0.95, 0.97, 1.0), intensity=0.2, casts_shadows=False),
)
_SUN_SIZE = 1024  # pixels of the sun's picture
_SUN_AWAY = 30.0  # times the radius of what it lights: its rays are as good as parallel
_DARK = 0.48  # how much darker a shadow is
_SOFT = 1.2  # pixels of the sun's picture by which the shadow on the ground is soft
_BIAS = 3.0  # pixels of the sun's picture: a surface that is so little behind another one is the same one
_FARTHEST = 5000.0  # m
_ENDLESS = 100.0  # m: a box as wide is a ground, as `drake_twin.description.sdf_shapes` makes of planes
_GROUND_COLOR = (0.74, 0.77, 0.74)
_GROUND_LIGHT = 0.93


@dataclass(frozen=True)
class Subjects:
    """What the camera keeps in the picture: corners of the robots' shapes.

    Attributes:
        corners: The corners of each shape in its body, or in the world if it does not move (m), shape (shapes, 8, 3).
        moves: The place of each shape's body in `SeenScene.bodies`; -1 if it does not move.
    """

    corners: np.ndarray
    moves: np.ndarray

    def points(self, poses: np.ndarray) -> np.ndarray:
        """Return the corners in the world (m), shape (n, 3), given the poses of the bodies, (bodies, 3, 4)."""
        known = np.concatenate([poses, np.eye(4)[np.newaxis, :3]])[self.moves]
        found: np.ndarray = np.einsum("nij,nkj->nki", known[:, :, :3], self.corners) + known[:, np.newaxis, :, 3]
        return found.reshape(-1, 3)


class Stage:
    """Draws one scene.

    Args:
        scene: What there is to see; its lights and its sky are left out for those of the page.
        subjects: What the camera keeps in the picture.

    Raises:
        NoOpenGLError: If OpenGL is missing.
        RuntimeError: If a file cannot be read.
    """

    def __init__(self, scene: SeenScene, subjects: Subjects):
        self._subjects = subjects
        self._ground, color = _ground(scene.shapes)
        self._color = np.array(color) * _GROUND_LIGHT
        shapes = tuple(_shown(shape) for shape in scene.shapes if _level(shape) is None)
        r, g, b = self._color.tolist()
        self._painter = Painter(replace(scene, shapes=shapes, lights=_LIGHTS, background=(r, g, b)))
        self._shot: Shot | None = None
        self._backdrop: Backdrop | None = None
        self._rays = np.zeros(0)
        # Where a driver is missing, VTK ends the process with its first picture: better here than later.
        still = np.tile(np.eye(4)[:3], (len(scene.bodies) + 1, 1, 1))
        self._painter.draw(View(COLOR, 8, 8, (8.0, 8.0, 4.0, 4.0), 0.1, 10.0), still)

    def picture(self, camera: Camera, poses: np.ndarray) -> np.ndarray:
        """Return the next picture, (height, width, 3), 8 bits each.

        Args:
            camera: The camera, which moves on.
            poses: The poses of the bodies that move, (bodies, 3, 4).
        """
        points = self._subjects.points(poses)
        shot = camera.shot(points)
        if shot != self._shot:
            self._shot, self._rays = shot, rays(shot)
            self._backdrop = backdrop(shot, self._rays, self._ground, self._color)
        assert self._backdrop is not None
        seen = np.concatenate([poses, shot.pose[np.newaxis]])
        width, height = shot.size
        intrinsics = (shot.focal, shot.focal, (width - 1) / 2.0, (height - 1) / 2.0)
        near = min(0.05, shot.distance / 50.0)
        view = View(COLOR, width, height, intrinsics, near, _FARTHEST)
        drawn = self._painter.draw(view, seen).astype(np.float32)
        depth = self._painter.draw(view._replace(kind=DEPTH), seen)
        is_thing = np.isfinite(depth)
        # Edges are mixed with the renderer's own background, which has the ground's color.
        empty = np.round(255.0 * self._color).astype(np.float32)
        found = np.where(is_thing[:, :, None], drawn, 255.0 * self._backdrop.picture + (drawn - empty))
        shadow = self._shadow(points, poses, shot, depth, is_thing)
        found *= (1.0 - _DARK * shadow)[:, :, None]
        return np.clip(found + 0.5, 0.0, 255.0).astype(np.uint8)

    def _shadow(
        self, subjects: np.ndarray, poses: np.ndarray, shot: Shot, depth: np.ndarray, is_thing: np.ndarray
    ) -> np.ndarray:
        """Return how much of the sun does not reach each pixel (0 to 1), near the robots."""
        assert self._backdrop is not None
        found = np.zeros(depth.shape, np.float32)
        if not len(subjects):
            return found
        low, high = subjects.min(axis=0), subjects.max(axis=0)
        center, radius = (low + high) / 2.0, 0.75 * float(np.linalg.norm(high - low)) + 0.3
        away = _SUN_AWAY * radius
        axes = looking_along(-_TO_SUN)
        sun = np.column_stack([axes, center + away * _TO_SUN])
        focal = _SUN_SIZE / 2.0 * _SUN_AWAY
        middle = (_SUN_SIZE - 1) / 2.0
        view = View(DEPTH, _SUN_SIZE, _SUN_SIZE, (focal, focal, middle, middle), 0.01, 3.0 * away)
        lit = self._painter.draw(view, np.concatenate([poses, sun[np.newaxis]]))

        def seen_by_sun(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            x, y, z = axes.T.astype(np.float32) @ (points - sun[:, 3].astype(np.float32)).T
            return np.array([focal * y / z + middle, focal * x / z + middle]), z

        def near(points: np.ndarray) -> np.ndarray:
            found: np.ndarray = ((points - center.astype(np.float32)) ** 2).sum(axis=-1) < radius**2
            return found

        rows, columns = np.nonzero(self._backdrop.is_ground & ~is_thing & near(self._backdrop.points))
        if len(rows):
            # The ground is behind all that casts shadows, so that it has no own.
            cast = gaussian_filter(np.isfinite(lit).astype(np.float32), _SOFT)
            places, _ = seen_by_sun(self._backdrop.points[rows, columns])
            found[rows, columns] = map_coordinates(cast, places, order=1)
        rows, columns = np.nonzero(is_thing)
        points = shot.position.astype(np.float32) + depth[rows, columns, None] * self._rays[rows, columns]
        inside = near(points)
        rows, columns, points = rows[inside], columns[inside], points[inside]
        if len(rows):
            places, far = seen_by_sun(points)
            lit = np.minimum(lit, 3.0 * away)  # no infinity minus infinity
            row, column = (np.clip(np.round(each).astype(int), 1, _SUN_SIZE - 2) for each in places)
            here = lit[row, column]
            far -= _BIAS * far / focal
            for below, above in (((1, 0), (-1, 0)), ((0, 1), (0, -1))):  # the steeper, the more
                steps = [np.abs(lit[row + down, column + right] - here) for down, right in (below, above)]
                far -= 2.0 * np.minimum(*steps)
            for down, right in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
                found[rows, columns] += 0.25 * (lit[row + down, column + right] < far)
        return found


def _level(shape: SeenShape) -> float | None:
    """Return the height of a level ground without an end, or with one that is far away; None for other shapes."""
    is_level = shape.moves is None and abs(shape.pose[10] - 1.0) < 1e-9 and not shape.texture
    if is_level and shape.kind == "plane":
        return shape.pose[11]
    if is_level and shape.kind == "box" and min(shape.sizes[:2]) >= _ENDLESS:  # what an SDF file's plane becomes
        return shape.pose[11] + shape.sizes[2] / 2.0
    return None


def _ground(shapes: Sequence[SeenShape]) -> tuple[float | None, tuple[float, ...]]:
    """Return the height of the highest ground and its color; no height without one."""
    grounds = [(height, shape.color[:3]) for shape in shapes if (height := _level(shape)) is not None]
    height, color = max(grounds, key=lambda ground: ground[0], default=(None, ()))
    return height, color or _GROUND_COLOR


def _shown(shape: SeenShape) -> SeenShape:
    """Return a shape with its color as light, which the renderer turns into the color of the file again."""
    return replace(shape, color=(*(part**2.2 for part in shape.color[:3]), *shape.color[3:]))
