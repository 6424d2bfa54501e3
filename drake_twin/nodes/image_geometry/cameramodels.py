"""Stand-in for ``image_geometry.cameramodels``. Rectification needs OpenCV (``pip install opencv-python-headless``)."""

import copy
import importlib
from math import atan, inf, nan, sqrt
from typing import Any

import numpy as np

Pixel = tuple[float, float]  # u to the right, v down
Point = tuple[float, float, float]  # in the camera's optical frame (m): z to the front, x to the right, y down


class PinholeCameraModel:
    """A camera by its ``CameraInfo``, with matrices as in it: `K`, `D`, `R` and `P`, for the binning and the region."""

    def __init__(self) -> None:
        self.K: Any = None
        self.D: Any = None
        self.R: Any = None
        self.P: Any = None
        self.full_K: Any = None
        self.full_P: Any = None
        self.width: Any = None
        self.height: Any = None
        self.binning_x: Any = None
        self.binning_y: Any = None
        self.raw_roi: Any = None
        self.resolution: Any = None
        self.tf_frame: Any = None
        self.stamp: Any = None

    def fromCameraInfo(self, msg: Any) -> None:
        """Take the parameters of a ``CameraInfo``."""
        self.D = _matrix(msg.d, len(msg.d), 1) if len(msg.d) else None
        self.R = _matrix(msg.r, 3, 3)
        self.full_K, self.full_P = _matrix(msg.k, 3, 3), _matrix(msg.p, 3, 4)
        self.resolution = self.width, self.height = msg.width, msg.height
        self.binning_x, self.binning_y = max(1, msg.binning_x), max(1, msg.binning_y)
        self.tf_frame, self.stamp = msg.header.frame_id, msg.header.stamp
        region = self.raw_roi = copy.copy(msg.roi)
        if not (region.x_offset or region.y_offset or region.width or region.height):
            region.width, region.height = self.width, self.height
        self.K, self.P = self.full_K.copy(), self.full_P.copy()
        for matrix in (self.K, self.P):
            matrix[:2, 2] -= [[region.x_offset], [region.y_offset]]
            for axis, binning in enumerate((self.binning_x, self.binning_y)):
                matrix[axis, axis] /= binning
                matrix[axis, 2] /= binning

    def rectifyImage(self, raw: np.ndarray, rectified: np.ndarray) -> None:
        """Write an image without its distortion into `rectified`.

        Raises:
            ImportError: Without OpenCV.
        """
        cv2, size = _opencv(), (self.width, self.height)
        self.mapx, self.mapy = cv2.initUndistortRectifyMap(self.K, self.D, self.R, self.P, size, cv2.CV_32FC1)
        cv2.remap(raw, self.mapx, self.mapy, cv2.INTER_CUBIC, rectified)

    def rectifyPoint(self, uv_raw: Pixel) -> Any:
        """Return where a pixel is in the image without distortion.

        Raises:
            ImportError: Without OpenCV.
        """
        raw = np.array(uv_raw, dtype=float).reshape(1, 1, 2)
        return _opencv().undistortPoints(raw, self.K, self.D, R=self.R, P=self.P)[0, 0]

    def project3dToPixel(self, point: Point) -> Pixel:
        """Return the pixel of the rectified image that a point is at; NaN in the plane of the camera."""
        u, v, w = (self.P @ np.array([*point[:3], 1.0])).A1
        return (u / w, v / w) if w else (nan, nan)

    def projectPixelTo3dRay(self, uv: Pixel) -> Point:
        """Return the unit vector towards what is seen at a pixel of the rectified image."""
        x, y = (uv[0] - self.cx()) / self.fx(), (uv[1] - self.cy()) / self.fy()
        length = sqrt(x * x + y * y + 1)
        return x / length, y / length, 1 / length

    def getDeltaU(self, deltaX: float, Z: float) -> float:
        """Return how many pixels a distance along x (m) has at a depth (m)."""
        return self.fx() * deltaX / Z if Z else inf

    def getDeltaV(self, deltaY: float, Z: float) -> float:
        """Return how many pixels a distance along y (m) has at a depth (m)."""
        return self.fy() * deltaY / Z if Z else inf

    def getDeltaX(self, deltaU: float, Z: float) -> float:
        """Return the distance along x (m) of pixels at a depth (m)."""
        return Z * deltaU / self.fx()

    def getDeltaY(self, deltaV: float, Z: float) -> float:
        """Return the distance along y (m) of pixels at a depth (m)."""
        return Z * deltaV / self.fy()

    def fullResolution(self) -> Any:
        """Return the width and the height (px) without binning and region."""
        return self.resolution

    def intrinsicMatrix(self) -> Any:
        """Return K, shape (3, 3)."""
        return self.K

    def distortionCoeffs(self) -> Any:
        """Return D, shape (n, 1); None without distortion."""
        return self.D

    def rotationMatrix(self) -> Any:
        """Return R, shape (3, 3)."""
        return self.R

    def projectionMatrix(self) -> Any:
        """Return P, shape (3, 4)."""
        return self.P

    def fullIntrinsicMatrix(self) -> Any:
        """Return K without binning and region, shape (3, 3)."""
        return self.full_K

    def fullProjectionMatrix(self) -> Any:
        """Return P without binning and region, shape (3, 4)."""
        return self.full_P

    def cx(self) -> float:
        """Return the centre along u (px)."""
        return float(self.P[0, 2])

    def cy(self) -> float:
        """Return the centre along v (px)."""
        return float(self.P[1, 2])

    def fx(self) -> float:
        """Return the focal length along u (px)."""
        return float(self.P[0, 0])

    def fy(self) -> float:
        """Return the focal length along v (px)."""
        return float(self.P[1, 1])

    def Tx(self) -> float:
        """Return P's term of translation along x (px·m): minus the focal length times the baseline."""
        return float(self.P[0, 3])

    def Ty(self) -> float:
        """Return P's term of translation along y (px·m)."""
        return float(self.P[1, 3])

    def fovX(self) -> float:
        """Return the horizontal field of view (rad)."""
        return 2 * atan(self.width / (2 * self.fx()))

    def fovY(self) -> float:
        """Return the vertical field of view (rad)."""
        return 2 * atan(self.height / (2 * self.fy()))

    def tfFrame(self) -> Any:
        """Return the camera's frame."""
        return self.tf_frame


class StereoCameraModel:
    """Two rectified cameras side by side; points are in the frame of the left one."""

    def __init__(self) -> None:
        self.left = PinholeCameraModel()
        self.right = PinholeCameraModel()
        self.Q: Any = None

    def fromCameraInfo(self, left_msg: Any, right_msg: Any) -> None:
        """Take the parameters of both cameras' ``CameraInfo``."""
        self.left.fromCameraInfo(left_msg)
        self.right.fromCameraInfo(right_msg)
        right = self.right
        self.Q = _matrix(np.eye(4), 4, 4)
        self.Q[:, 3] = [[-right.cx()], [-right.cy()], [right.fx()], [0.0]]
        self.Q[2, 2], self.Q[3, 2] = 0.0, -right.fx() / right.Tx()

    def tfFrame(self) -> Any:
        """Return the frame of the points."""
        return self.left.tfFrame()

    def project3dToPixel(self, point: Point) -> tuple[Pixel, Pixel]:
        """Return a point's pixels in the left and in the right image."""
        return self.left.project3dToPixel(point), self.right.project3dToPixel(point)

    def projectPixelTo3d(self, left_uv: Pixel, disparity: float) -> Point:
        """Return the point that is seen at a pixel of the left image, by its disparity (px); zeros for none."""
        x, y, z, w = (self.Q @ np.array([*left_uv, disparity, 1.0])).A1
        return (x / w, y / w, z / w) if w else (0.0, 0.0, 0.0)

    def getZ(self, disparity: float) -> float:
        """Return the depth (m) of a disparity (px)."""
        return -self.right.Tx() / disparity if disparity else inf

    def getDisparity(self, Z: float) -> float:
        """Return the disparity (px) of a depth (m)."""
        return -self.right.Tx() / Z if Z else inf


def _matrix(numbers: Any, rows: int, columns: int) -> Any:
    return np.asmatrix(np.array(numbers, dtype=float).reshape(rows, columns))


def _opencv() -> Any:
    try:
        return importlib.import_module("cv2")
    except ImportError:
        raise ImportError("rectification needs OpenCV: pip install opencv-python-headless") from None
