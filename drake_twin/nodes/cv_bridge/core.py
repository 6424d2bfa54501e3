"""Stand-in for ``cv_bridge.core``. Compressed images are read and written by Pillow."""

from array import array
from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image, UnidentifiedImageError

from drake_twin.nodes.cv_bridge.encodings import DEPTHS, CvBridgeError, converted, cv_type, encoding_of
from drake_twin.nodes.message_classes import message_class

__all__ = ["CvBridge", "CvBridgeError"]

_FORMATS = {
    **dict.fromkeys(("jpg", "jpeg", "jpe"), "JPEG"),
    **dict.fromkeys(("bmp", "dib"), "BMP"),
    **dict.fromkeys(("pbm", "pgm", "ppm"), "PPM"),
    **dict.fromkeys(("tif", "tiff"), "TIFF"),
    "jp2": "JPEG2000",
    "png": "PNG",
    "webp": "WEBP",
}
_QUALITY = 95  # OpenCV's of JPEG


class CvBridge:
    """Makes images of ROS and NumPy arrays, shape (height, width) or (height, width, channels), of each other."""

    def __init__(self) -> None:
        kinds = [*DEPTHS.items()]
        self.cvdepth_to_numpy_depth = {number: kind for number, (_, kind) in enumerate(kinds)}
        self.numpy_type_to_cvtype = {kind: depth for depth, kind in kinds} | dict(kinds)
        names = [f"{depth}C{channels}" for depth, _ in kinds for channels in range(1, 5)]
        self.cvtype_to_name = {cv_type(name): name for name in names}

    def dtype_with_channels_to_cvtype2(self, dtype: np.dtype, n_channels: int) -> str:
        """Return the encoding of numbers of a type, for example ``8UC3``."""
        if dtype.name not in DEPTHS.values():
            raise CvBridgeError(f"an image of {dtype.name} has no encoding")
        return f"{self.numpy_type_to_cvtype[dtype.name]}C{n_channels}"

    def cvtype2_to_dtype_with_channels(self, cvtype: int) -> tuple[str, int]:
        """Return the NumPy type of one of OpenCV's types, and how many numbers a pixel has."""
        return self.cvdepth_to_numpy_depth[cvtype % 8], cvtype // 8 + 1

    def encoding_to_cvtype2(self, encoding: str) -> int:
        """Return OpenCV's number of an encoding's type.

        Raises:
            CvBridgeError: If the encoding is unknown.
        """
        return cv_type(encoding)

    def encoding_to_dtype_with_channels(self, encoding: str) -> tuple[str, int]:
        """Return the NumPy type of an encoding, and how many numbers a pixel has.

        Raises:
            CvBridgeError: If the encoding is unknown.
        """
        return self.cvtype2_to_dtype_with_channels(self.encoding_to_cvtype2(encoding))

    def imgmsg_to_cv2(self, img_msg: Any, desired_encoding: str = "passthrough") -> np.ndarray:
        """Return an ``Image`` as an array.

        Args:
            img_msg: The message; an array in its own encoding shares its bytes.
            desired_encoding: The encoding that is wanted; by default the message's own.

        Raises:
            CvBridgeError: If the image is not converted into that.
        """
        its = encoding_of(img_msg.encoding)
        kind = its.kind.newbyteorder(">" if img_msg.is_bigendian else "<")
        size, pixel = img_msg.height * img_msg.step, kind.itemsize * its.channels
        if img_msg.step < img_msg.width * pixel or len(img_msg.data) < size:
            what = f"{len(img_msg.data)} bytes in rows of {img_msg.step}"
            raise CvBridgeError(f"the image is too short: {what} for {img_msg.width} x {img_msg.height} {its.name}")
        shape = img_msg.height, img_msg.width, its.channels
        strides = img_msg.step, pixel, kind.itemsize
        data = bytes(img_msg.data) if isinstance(img_msg.data, list) else img_msg.data
        image: np.ndarray = np.ndarray(shape, kind, data, strides=strides) if size else np.zeros(shape, kind)
        image = np.ascontiguousarray(image[..., 0] if its.channels == 1 else image, dtype=its.kind)
        return image if desired_encoding == "passthrough" else converted(image, its.name, desired_encoding)

    def cv2_to_imgmsg(self, cvim: np.ndarray, encoding: str = "passthrough", header: Any = None) -> Any:
        """Return an array as an ``Image``.

        Args:
            cvim: The array.
            encoding: The encoding that its numbers have; by default only their type and the channels, as ``8UC3``.
            header: The message's header.

        Raises:
            TypeError: If `cvim` is not an array.
            CvBridgeError: If the encoding has other numbers.
        """
        own = self._own_encoding(cvim)
        if encoding != "passthrough" and cv_type(encoding) != cv_type(own):
            raise CvBridgeError(f"encoding specified as {encoding}, but image has incompatible type {own}")
        message = message_class("sensor_msgs/msg/Image")()
        message.height, message.width = cvim.shape[:2]
        message.encoding = own if encoding == "passthrough" else encoding
        message.is_bigendian = int(cvim.dtype.byteorder == ">")
        if header is not None:
            message.header = header
        message.data = array("B", cvim.tobytes())
        message.step = len(message.data) // max(message.height, 1)
        return message

    def compressed_imgmsg_to_cv2(self, cmprs_img_msg: Any, desired_encoding: str = "passthrough") -> np.ndarray:
        """Return a ``CompressedImage`` as an array: grey, BGR or BGRA, or in the encoding that is wanted.

        Raises:
            CvBridgeError: If it cannot be read, or is not converted into that.
        """
        try:
            with Image.open(BytesIO(bytes(cmprs_img_msg.data))) as picture:
                image = _array(picture)
        except (UnidentifiedImageError, OSError) as error:
            raise CvBridgeError(f"the compressed image cannot be read ({error})") from error
        if desired_encoding == "passthrough":
            return image
        colours = {1: "mono", 3: "bgr", 4: "bgra"}[1 if image.ndim == 2 else image.shape[2]]
        return converted(image, f"{colours}{8 * image.itemsize}", desired_encoding)

    def cv2_to_compressed_imgmsg(self, cvim: np.ndarray, dst_format: str = "jpg") -> Any:
        """Return a grey, BGR or BGRA array as a ``CompressedImage``.

        Raises:
            TypeError: If `cvim` is not an array.
            CvBridgeError: If such an array cannot be written in the format.
        """
        own = self._own_encoding(cvim)
        if dst_format not in _FORMATS:
            raise CvBridgeError(f"unknown format {dst_format!r}; it may be {', '.join(sorted(_FORMATS))}")
        colours = {"8UC1": "mono8", "8UC3": "rgb8", "8UC4": "rgba8", "16UC1": "mono16"}
        if own not in colours:
            raise CvBridgeError(f"an image of type {own} cannot be written as {dst_format}")
        source = colours[own].replace("rgb", "bgr")
        format_name = _FORMATS[dst_format]
        wanted = "rgb8" if format_name == "JPEG" and own == "8UC4" else colours[own]
        image = converted(np.reshape(cvim, cvim.shape[:2]) if own.endswith("C1") else cvim, source, wanted)
        out = BytesIO()
        try:
            Image.fromarray(image).save(out, format_name, **({"quality": _QUALITY} if format_name == "JPEG" else {}))
        except (OSError, ValueError) as error:
            raise CvBridgeError(f"the image cannot be written as {dst_format} ({error})") from error
        return message_class("sensor_msgs/msg/CompressedImage")(format=dst_format, data=array("B", out.getvalue()))

    def _own_encoding(self, image: Any) -> str:
        if not isinstance(image, np.ndarray):
            raise TypeError(f"{type(image).__name__} is not a NumPy array")
        if image.ndim not in (2, 3):
            raise CvBridgeError(f"an image has two or three dimensions, not {image.ndim}")
        return self.dtype_with_channels_to_cvtype2(image.dtype, 1 if image.ndim == 2 else image.shape[2])


def _array(picture: Image.Image) -> np.ndarray:
    """Return a picture as OpenCV reads it."""
    if picture.mode.startswith("I"):
        return np.array(picture).astype(np.uint16)
    if picture.mode in ("1", "L"):
        return np.array(picture.convert("L"))
    is_clear = picture.mode in ("RGBA", "LA", "PA") or "transparency" in picture.info
    image = np.array(picture.convert("RGBA" if is_clear else "RGB"))
    return converted(image, "rgba8" if is_clear else "rgb8", "bgra8" if is_clear else "bgr8")
