"""The encodings of ``sensor_msgs/msg/Image``, and images of one as images of another, as cv_bridge makes them.

Grey values are OpenCV's, to the bit. Bayer and YUV images need OpenCV (``pip install opencv-python-headless``).
"""

import importlib
import re
from typing import Any

import numpy as np

from drake_twin.dataclass import dataclass

DEPTHS = {
    "8U": "uint8",
    "8S": "int8",
    "16U": "uint16",
    "16S": "int16",
    "32S": "int32",
    "32F": "float32",
    "64F": "float64",
}
_BAYER = {"bayer_rggb": "BayerBG", "bayer_bggr": "BayerRG", "bayer_gbrg": "BayerGR", "bayer_grbg": "BayerGB"}
_YUV = {"yuv422": "UYVY", "uyvy": "UYVY", "yuv422_yuy2": "YUY2", "yuyv": "YUY2"}
_COLOURS = {"mono": 1, "rgb": 3, "bgr": 3, "rgba": 4, "bgra": 4}
_GREY = {"r": 9798, "g": 19235, "b": 3735}  # 0.299, 0.587, 0.114 times 2**15, as OpenCV has them


class CvBridgeError(TypeError):
    """An image that cannot be converted."""


@dataclass(frozen=True)
class Encoding:
    """An encoding.

    Attributes:
        name: Its name.
        kind: The NumPy type of its numbers.
        channels: How many of them a pixel has.
        colours: ``mono``, ``rgb``, ``bgr``, ``rgba``, ``bgra``, a Bayer pattern or a YUV format; empty without.
    """

    name: str
    kind: np.dtype
    channels: int
    colours: str = ""


def encoding_of(name: str) -> Encoding:
    """Return an encoding by its name, for example ``bgr8``, ``mono16`` or ``32FC1``.

    Raises:
        CvBridgeError: If the encoding is unknown.
    """
    if match := re.fullmatch(r"(8U|8S|16U|16S|32S|32F|64F)(?:C(\d+))?", name):
        return Encoding(name, np.dtype(DEPTHS[match[1]]), int(match[2] or 1))
    if name in _YUV:
        return Encoding(name, np.dtype("uint8"), 2, name)
    match = re.fullmatch(r"(\w*?)(8|16)", name)
    if match and (match[1] in _COLOURS or match[1] in _BAYER):
        return Encoding(name, np.dtype(f"uint{match[2]}"), _COLOURS.get(match[1], 1), match[1])
    raise CvBridgeError(f"Unrecognized image encoding [{name}]")


def cv_type(encoding: str) -> int:
    """Return OpenCV's number of an encoding's type, for example 16 (``CV_8UC3``) for ``bgr8``."""
    found = encoding_of(encoding)
    return [*DEPTHS.values()].index(found.kind.name) + 8 * (found.channels - 1)


def converted(image: np.ndarray, source: str, target: str) -> np.ndarray:
    """Return an image in another encoding.

    Args:
        image: Shape (height, width), or (height, width, channels) of two or more.
        source: Its encoding.
        target: The encoding that is wanted.

    Raises:
        CvBridgeError: If cv_bridge does not convert the one into the other.
    """
    if source == target:
        return image.copy()
    its, wanted = encoding_of(source), encoding_of(target)
    if not (its.colours and wanted.colours):
        if its.channels != wanted.channels or (wanted.colours and not its.colours):
            raise CvBridgeError(f"[{source}] is not converted into [{target}]: both need colours, or as many channels")
    elif its.colours != wanted.colours:
        image = _recoloured(image, its, wanted)
    return _of_depth(image, its.kind, wanted.kind)


def _of_depth(image: np.ndarray, its: np.dtype, wanted: np.dtype) -> np.ndarray:
    if its == wanted:
        return image.copy()
    factor = {(8, 16): 257.0, (16, 8): 1 / 257.0}.get((8 * its.itemsize, 8 * wanted.itemsize), 1.0)
    if wanted.kind == "f":
        return image.astype(wanted)
    limits = np.iinfo(wanted)
    return np.clip(np.rint(image * factor), limits.min, limits.max).astype(wanted)


def _recoloured(image: np.ndarray, its: Encoding, wanted: Encoding) -> np.ndarray:
    if wanted.colours not in _COLOURS or (its.colours in _BAYER and wanted.channels == 4):
        raise CvBridgeError(f"Unsupported conversion from [{its.name}] to [{wanted.name}]")
    if its.colours not in _COLOURS:
        return _by_opencv(image, its, wanted)
    if its.colours == "mono":
        planes = dict.fromkeys("rgb", image)
    else:
        planes = {colour: image[..., index] for index, colour in enumerate(its.colours)}
    if wanted.colours == "mono":
        total = sum(weight * planes[colour].astype(np.int64) for colour, weight in _GREY.items())
        return ((np.asarray(total) + (1 << 14)) >> 15).astype(its.kind)
    planes.setdefault("a", np.full(image.shape[:2], np.iinfo(its.kind).max, dtype=its.kind))
    return np.stack([planes[colour] for colour in wanted.colours], axis=-1)


def _by_opencv(image: np.ndarray, its: Encoding, wanted: Encoding) -> np.ndarray:
    try:
        cv2: Any = importlib.import_module("cv2")
    except ImportError:
        what = f"[{its.name}] into [{wanted.name}] needs OpenCV: pip install opencv-python-headless"
        raise CvBridgeError(what) from None
    colours = "GRAY" if wanted.colours == "mono" else wanted.colours.upper()
    if its.colours in _BAYER:
        name = f"COLOR_{_BAYER[its.colours]}2{colours}"
    else:
        name = f"COLOR_YUV2{colours}_{_YUV[its.colours]}"
    return np.asarray(cv2.cvtColor(image, getattr(cv2, name)))
