"""The lens of a camera: where a point of the world is in its picture, and which way each pixel looks.

All directions are in the optical frame: x to the right, y down, z forward. The center of the pixel in column u and row
v has the coordinates (u, v), as in OpenCV and ROS.
"""

from functools import cached_property
from math import ceil, floor

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.sensors.cameras.settings import CameraSettings, Intrinsics

_MOST_WIDENED = 4.0  # times the picture's size: what is beyond is black
_NEWTON_STEPS = 30
_EXACT = 1e-9  # of a focal length


@dataclass(frozen=True)
class Pinhole:
    """A picture without distortion, as the renderer draws it.

    Attributes:
        width: In pixels.
        height: In pixels.
        intrinsics: Its focal lengths and center (pixels).
    """

    width: int
    height: int
    intrinsics: Intrinsics


class Lens:
    """The lens of a camera.

    With distortion the renderer draws a pinhole's picture, wide enough, in which each pixel of the camera's picture is
    looked up: the plumb bob model of OpenCV and ``sensor_msgs/msg/CameraInfo``.

    Args:
        settings: The camera.
    """

    def __init__(self, settings: CameraSettings):
        self._settings = settings

    @property
    def is_distorted(self) -> bool:
        """Whether there is distortion."""
        return any(self._settings.distortion)

    @cached_property
    def slopes(self) -> tuple[np.ndarray, np.ndarray]:
        """The direction of each pixel: x / z and y / z, (height, width) each; NaN where the lens shows nothing."""
        settings = self._settings
        fx, fy, cx, cy = settings.drawn
        columns, rows = np.meshgrid(np.arange(settings.width), np.arange(settings.height))
        x, y = (columns - cx) / fx, (rows - cy) / fy
        return undistorted(x, y, settings.distortion) if self.is_distorted else (x, y)

    @cached_property
    def pinhole(self) -> Pinhole:
        """The picture that the renderer draws: the camera's own, or with distortion one that covers it."""
        settings = self._settings
        if not self.is_distorted:
            return Pinhole(settings.width, settings.height, settings.drawn)
        fx, fy, cx, cy = settings.drawn
        shifts, sizes = [], []
        for slopes, focal, center, size in zip(
            self.slopes, (fx, fy), (cx, cy), (settings.width, settings.height), strict=True
        ):
            places = slopes[np.isfinite(slopes)] * focal + center
            margin = (_MOST_WIDENED - 1.0) / 2.0 * size
            least = floor(max(float(places.min(initial=0.0)), -margin)) - 1
            most = ceil(min(float(places.max(initial=size - 1.0)), size - 1.0 + margin)) + 1
            shifts.append(-least)
            sizes.append(most - least + 1)
        return Pinhole(sizes[0], sizes[1], Intrinsics(fx, fy, cx + shifts[0], cy + shifts[1]))

    @cached_property
    def _places(self) -> np.ndarray:
        """Where each pixel's direction is in the pinhole's picture: rows, then columns."""
        fx, fy, cx, cy = self.pinhole.intrinsics
        x, y = self.slopes
        return np.array([y * fy + cy, x * fx + cx])

    def distort(self, picture: np.ndarray, *, blend: bool = True) -> np.ndarray:
        """Return the camera's picture, given the pinhole's.

        Args:
            picture: Of shape (height, width) or (height, width, channels).
            blend: Whether to interpolate between pixels; the nearest one is taken otherwise.
        """
        if not self.is_distorted:
            return picture
        from scipy.ndimage import map_coordinates  # an import of a third of a second

        places = np.where(np.isfinite(self._places), self._places, -10.0)
        if not blend:
            nothing = np.inf if picture.dtype.kind == "f" else 0
            return np.asarray(map_coordinates(picture, places, order=0, cval=nothing))
        channels = picture.reshape(*picture.shape[:2], -1).astype(float)
        found = [map_coordinates(channels[:, :, index], places, order=1) for index in range(channels.shape[2])]
        values = np.rint(np.stack(found, axis=-1)).reshape(*places.shape[1:], *picture.shape[2:])
        return np.asarray(values.astype(picture.dtype))


def distorted(x: np.ndarray, y: np.ndarray, distortion: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Return where slopes are seen through a lens: k1, k2, p1, p2, k3 of OpenCV's ``projectPoints``."""
    k1, k2, p1, p2, k3 = distortion
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return (
        x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
        y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
    )


def undistorted(x: np.ndarray, y: np.ndarray, distortion: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Return the slopes that are seen at these ones; NaN where the lens shows none, or folds (Newton's method)."""
    k1, k2, p1, p2, k3 = distortion
    u, v = x.copy(), y.copy()
    with np.errstate(all="ignore"):
        for _ in range(_NEWTON_STEPS):
            du, dv = distorted(u, v, distortion)
            r2 = u * u + v * v
            radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
            slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3))
            a = radial + u * u * slope + 2.0 * p1 * v + 6.0 * p2 * u
            b = u * v * slope + 2.0 * p1 * u + 2.0 * p2 * v
            d = radial + v * v * slope + 6.0 * p1 * v + 2.0 * p2 * u
            determinant = a * d - b * b
            ex, ey = du - x, dv - y
            u, v = u - (d * ex - b * ey) / determinant, v - (a * ey - b * ex) / determinant
        du, dv = distorted(u, v, distortion)
        is_found = (np.abs(du - x) < _EXACT) & (np.abs(dv - y) < _EXACT) & (a > 0.0) & (determinant > 0.0)
    return np.where(is_found, u, np.nan), np.where(is_found, v, np.nan)
