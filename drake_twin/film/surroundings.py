"""What is around the robots in a film, as on the page: a sky, and a ground with a grid that fades far away."""

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.film.camera import Shot

SKY_TOP, SKY_BOTTOM = np.array([0.50, 0.67, 0.86]), np.array([0.93, 0.95, 0.97])
_FULL_SKY = 0.45  # the sine of the elevation from which on the sky has its top's color
_LINES = ((0.1, 0.10), (1.0, 0.28), (10.0, 0.42))  # m between two lines, and how dark they are
_WIDTH = 1.3  # pixels, of a line
_LEAST, _MOST, _TIMES = 60.0, 900.0, 25.0  # m: how far the ground is seen, from a camera that far from its target


@dataclass(frozen=True)
class Backdrop:
    """What a camera sees where nothing is.

    Attributes:
        picture: Its colors (0 to 1), shape (height, width, 3).
        is_ground: Where it is ground, shape (height, width).
        points: The points of the ground in the world (m), shape (height, width, 3); anything elsewhere.
    """

    picture: np.ndarray
    is_ground: np.ndarray
    points: np.ndarray


def rays(shot: Shot) -> np.ndarray:
    """Return the rays through the pixels, one long along the camera's axis, in the world: (height, width, 3)."""
    width, height = shot.size
    across = (np.arange(width, dtype=np.float32) - (width - 1) / 2.0) / shot.focal
    down = (np.arange(height, dtype=np.float32) - (height - 1) / 2.0) / shot.focal
    axes = shot.rotation.astype(np.float32)
    found: np.ndarray = across[None, :, None] * axes[:, 0] + down[:, None, None] * axes[:, 1] + axes[:, 2]
    return found


def backdrop(shot: Shot, ahead: np.ndarray, ground: float | None, color: np.ndarray) -> Backdrop:
    """Return what a camera sees where nothing is.

    Args:
        shot: The camera.
        ahead: Its `rays`.
        ground: The height of the ground (m); None without one.
        color: The color of the ground (0 to 1).
    """
    up = ahead[:, :, 2] / np.linalg.norm(ahead, axis=2)
    share = np.clip(up / _FULL_SKY, 0.0, 1.0)[:, :, None].astype(np.float32)
    picture = SKY_BOTTOM.astype(np.float32) * (1.0 - share) + SKY_TOP.astype(np.float32) * share
    eye = shot.position.astype(np.float32)
    if ground is None or eye[2] <= ground:
        return Backdrop(picture, np.zeros(up.shape, bool), np.zeros_like(ahead))
    is_ground = ahead[:, :, 2] < -1e-4
    depth = np.where(is_ground, (ground - eye[2]) / np.minimum(ahead[:, :, 2], -1e-4), 0.0)
    points = eye + depth[:, :, None] * ahead
    seen = np.clip(_TIMES * shot.distance, _LEAST, _MOST)
    fade = np.clip((depth / seen - 0.3) / 0.7, 0.0, 1.0)
    opacity = np.where(is_ground, 1.0 - fade * fade * (3.0 - 2.0 * fade), 0.0)[:, :, None].astype(np.float32)
    shade = (1.0 - _grid(points, depth, ahead, shot.focal))[:, :, None]
    picture = picture * (1.0 - opacity) + color.astype(np.float32) * shade * opacity
    return Backdrop(picture, is_ground, points)


def _grid(points: np.ndarray, depth: np.ndarray, ahead: np.ndarray, focal: float) -> np.ndarray:
    """Return how dark the grid makes the ground, 0 to 1; lines that would be closer than some pixels are left out."""
    down = np.maximum(-ahead[:, :, 2], 1e-4)
    found = np.zeros(depth.shape, np.float32)
    for axis in (0, 1):
        # How far apart in the world two pixels are along this axis, by the slope of the ray.
        pixel = depth / focal * np.sqrt(1.0 + (ahead[:, :, axis] / down) ** 2)
        for apart, dark in _LINES:
            at = points[:, :, axis] / apart
            width = np.maximum(pixel / apart, 1e-6)
            off = np.abs(at - np.round(at)) / width
            fade = 1.0 - np.clip((width - 0.06) / 0.24, 0.0, 1.0)
            found = np.maximum(found, dark * np.clip(_WIDTH - off, 0.0, 1.0) * fade)
    return found
