"""A camera that keeps robots in the picture."""

from math import exp, tan

import numpy as np

from drake_twin.dataclass import dataclass

FOV = 0.85  # rad, of the picture's height
_FROM = np.array([0.75, -0.65, 0.38])  # as the page's camera at the start, but lower: the horizon is seen
_MARGIN = 1.45  # of the picture to what it shows
_EDGE = 0.88  # of half the picture: what is farther out leaves it
_SMALLEST = 0.05  # m: the camera comes no closer than to a ball of this radius
_EASE = 0.3  # s in which the camera has come two thirds of its way


@dataclass(frozen=True)
class Shot:
    """Where a camera is.

    Attributes:
        target: The point in the picture's middle (m, in the world).
        distance: From there (m).
        size: The picture's width and height (pixels).
    """

    target: tuple[float, float, float]
    distance: float
    size: tuple[int, int]

    @property
    def focal(self) -> float:
        """The focal length (pixels)."""
        return self.size[1] / 2.0 / tan(FOV / 2.0)

    @property
    def rotation(self) -> np.ndarray:
        """The axes of the optical frame in the world: right, down, ahead; a matrix (3, 3)."""
        return looking_along(-_FROM)

    @property
    def position(self) -> np.ndarray:
        """The camera's position in the world (m)."""
        return np.array(self.target) + self.distance * _FROM / np.linalg.norm(_FROM)

    @property
    def pose(self) -> np.ndarray:
        """The pose of the optical frame in the world, a matrix (3, 4)."""
        return np.column_stack([self.rotation, self.position])


class Camera:
    """Stands still until a robot leaves the picture, then moves on to where all are in it.

    Args:
        size: The picture's width and height (pixels).
        rate: Pictures per second.
    """

    def __init__(self, size: tuple[int, int], rate: float):
        self._size = size
        self._share = 1.0 - exp(-1.0 / (rate * _EASE))
        self._now: np.ndarray | None = None  # target and distance
        self._goal = np.zeros(4)

    def shot(self, corners: np.ndarray) -> Shot:
        """Return where the camera is for the next picture.

        Args:
            corners: Points of the robots (m, in the world), shape (n, 3).
        """
        if self._now is None:
            self._now = self._goal = self._fit(corners)
        elif not self._sees(corners):
            self._goal = self._fit(corners)
            self._goal[3] = max(self._goal[3], self._now[3])  # robots that come together do not make it restless
        if np.abs(self._goal - self._now).max() < 1e-3 * self._goal[3]:
            self._goal = self._now  # so that it stands still again
        self._now = self._now + self._share * (self._goal - self._now)
        x, y, z, distance = self._now.tolist()
        return Shot((x, y, z), distance, self._size)

    def _fit(self, corners: np.ndarray) -> np.ndarray:
        """Return the target and the distance at which all points are in the picture, with a margin."""
        if not len(corners):
            corners = np.array([[-1.0, -1.0, 0.0], [1.0, 1.0, 0.5]])
        target = (corners.min(axis=0) + corners.max(axis=0)) / 2.0
        right, down, ahead = looking_along(-_FROM).T @ (corners - target).T
        height = tan(FOV / 2.0) / _MARGIN
        width = height * self._size[0] / self._size[1]
        reach = np.maximum(np.abs(right) / width, np.abs(down) / height) - ahead
        return np.append(target, max(float(reach.max()), _SMALLEST / min(height, width)))

    def _sees(self, corners: np.ndarray) -> bool:
        assert self._now is not None
        if not len(corners):
            return True
        shot = Shot(tuple(self._now[:3].tolist()), float(self._now[3]), self._size)
        right, down, ahead = shot.rotation.T @ (corners - shot.position).T
        height = _EDGE * tan(FOV / 2.0)
        width = height * self._size[0] / self._size[1]
        return bool(np.all((np.abs(right) < width * ahead) & (np.abs(down) < height * ahead)))


def looking_along(direction: np.ndarray) -> np.ndarray:
    """Return the axes of a frame that looks along a direction, not a vertical one: right, down, ahead (3, 3)."""
    ahead = direction / np.linalg.norm(direction)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    return np.column_stack([right, np.cross(ahead, right), ahead])
