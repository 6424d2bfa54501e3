"""The messages of cameras, as functions of pictures."""

from typing import Any

import numpy as np

from drake_twin import messages
from drake_twin.sensors.cameras.settings import CameraSettings
from drake_twin.sensors.scan_messages import cloud_message

_GREY = np.array([0.299, 0.587, 0.114])  # ITU-R BT.601
_DEPTH_ENCODING = "32FC1"
_CHANNELS = "rgb"


def camera_info(header: Any, settings: CameraSettings) -> Any:
    """Return a ``CameraInfo`` (ros_gz_bridge/src/convert/sensor_msgs.cpp)."""
    fx, fy, cx, cy = settings.published
    return messages.CameraInfo(
        header=header,
        height=settings.height,
        width=settings.width,
        distortion_model="plumb_bob",
        d=np.array([settings.distortion[index] for index in range(5)]),
        k=np.array([fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]),
        r=np.array(settings.rectification),
        p=np.array(settings.projection),
        binning_x=0,
        binning_y=0,
        roi=messages.RegionOfInterest(x_offset=0, y_offset=0, height=0, width=0, do_rectify=False),
    )


def image(header: Any, encoding: str, picture: np.ndarray) -> Any:
    """Return an ``Image`` of values that are already in its encoding."""
    height, width = picture.shape[:2]
    data = np.ascontiguousarray(picture).view(np.uint8).ravel()
    return messages.Image(
        header=header,
        height=height,
        width=width,
        encoding=encoding,
        is_bigendian=0,
        step=len(data) // height,
        data=data,
    )


def color_image(header: Any, encoding: str, picture: np.ndarray) -> Any:
    """Return an ``Image`` of a color picture (height, width, 3)."""
    return image(header, encoding, _encoded(picture, encoding))


def depth_image(header: Any, depth: np.ndarray) -> Any:
    """Return an ``Image`` of depths (m, height × width)."""
    return image(header, _DEPTH_ENCODING, depth)


def pixels(message: Any) -> np.ndarray:
    """Return the values of an ``Image``, (height, width) or (height, width, 3)."""
    kinds = {_DEPTH_ENCODING: np.float32, "mono16": np.uint16}
    values = np.asarray(message.data).view(kinds.get(message.encoding, np.uint8))
    return values.reshape(message.height, message.width, *((3,) if message.encoding in ("rgb8", "bgr8") else ()))


def _encoded(picture: np.ndarray, encoding: str) -> np.ndarray:
    if encoding == "bgr8":
        return picture[:, :, ::-1]
    if encoding in ("mono8", "mono16"):
        grey = picture @ _GREY
        kind, scale = (np.uint8, 1.0) if encoding == "mono8" else (np.uint16, 257.0)
        return np.asarray((scale * grey + 0.5).astype(kind))
    if encoding.startswith("bayer_"):
        mosaic = np.empty(picture.shape[:2], dtype=np.uint8)
        for place, channel in enumerate(encoding[6:10]):
            row, column = divmod(place, 2)
            mosaic[row::2, column::2] = picture[row::2, column::2, _CHANNELS.index(channel)]
        return mosaic
    return picture


def cloud(
    header: Any,
    slopes: tuple[np.ndarray, np.ndarray],
    depth: np.ndarray,
    picture: np.ndarray,
    *,
    is_optical: bool,
) -> Any:
    """Return the points that a depth camera sees as a ``PointCloud2``: x, y, z, rgb.

    Args:
        header: Its header.
        slopes: x / z and y / z of each pixel in the optical frame.
        depth: The depth of each pixel (m); points without a finite one have its value in x, y and z.
        picture: The color of each pixel.
        is_optical: Whether the points are in the optical frame, four bytes before their colors, as those of Gazebo
            classic's plugin are (gazebo_ros_camera.cpp); else x is forward and y to the left (gz-sensors,
            src/PointCloudUtil.cc).
    """
    offsets, size = ((0, 4, 8, 16), 32) if is_optical else ((0, 4, 8, 12), 16)
    names = ("x", "y", "z", "rgb")
    layout = np.dtype({"names": names, "formats": ("<f4", "<f4", "<f4", "<u4"), "offsets": offsets, "itemsize": size})
    is_finite = np.isfinite(depth)
    with np.errstate(invalid="ignore"):
        across, down = (np.where(is_finite, depth * slope, depth) for slope in slopes)
    if not is_optical:
        sign = np.where(is_finite, -1.0, 1.0)
        across, down = sign * across, sign * down
    data = np.zeros(depth.shape, dtype=layout)
    for name, values in zip(names, (across, down, depth) if is_optical else (depth, across, down), strict=False):
        data[name] = values
    colors = picture.astype(np.uint32)
    data["rgb"] = colors[:, :, 0] << 16 | colors[:, :, 1] << 8 | colors[:, :, 2]
    return cloud_message(header, data, is_dense=bool(is_finite.all()))
