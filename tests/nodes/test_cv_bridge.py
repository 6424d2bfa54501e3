"""``cv_bridge`` against OpenCV's numbers (5.0: grey values, PNG files) and bytes."""

import struct
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from drake_twin.nodes.cv_bridge import CvBridge, CvBridgeError, getCvType
from drake_twin.nodes.message_classes import message_class

Image = message_class("sensor_msgs/msg/Image")
PIXELS = np.array(
    [[[255, 0, 0], [0, 255, 0], [0, 0, 255], [10, 20, 30], [254, 1, 77], [128, 127, 129]]], dtype=np.uint8
)
COLOUR_PNG = (
    "89504e470d0a1a0a0000000d49484452000000020000000108020000007b40e8dd0000000f4944415408d763646662646666060000400011f6"
    "d250250000000049454e44ae426082"
)
DEPTH_PNG = (
    "89504e470d0a1a0a0000000d494844520000000200000001100000000081d9fc150000000d49444154081d636460fcff0f000309020023ecab"
    "110000000049454e44ae426082"
)
CLEAR_PNG = (
    "89504e470d0a1a0a0000000d49484452000000010000000108060000001f15c4890000000d49444154081d63606662640100001d000b18ac88"
    "dc0000000049454e44ae426082"
)
bridge = CvBridge()


def test_rows_with_padding_and_the_order_of_bytes():
    numbers = [[1, 2, 65535], [4, 5, 6]]
    for order in "<>":
        data = b"".join(struct.pack(f"{order}3H2x", *row) for row in numbers)
        message = Image(height=2, width=3, encoding="mono16", is_bigendian=int(order == ">"), step=8, data=data)
        image = bridge.imgmsg_to_cv2(message)
        assert (image.tolist(), image.dtype.str) == (numbers, np.dtype("uint16").str)


def test_an_array_shares_the_bytes_of_its_message():
    message = bridge.cv2_to_imgmsg(np.zeros((2, 2, 3), dtype=np.uint8), "bgr8")
    bridge.imgmsg_to_cv2(message)[1, 1, 2] = 7
    assert message.data[-1] == 7
    bridge.imgmsg_to_cv2(message, "bgr8")[1, 1, 2] = 9
    assert message.data[-1] == 7


def test_arrays_as_messages():
    header = message_class("std_msgs/msg/Header")(frame_id="camera")
    image = np.arange(6, dtype=np.float32).reshape(2, 3)
    message = bridge.cv2_to_imgmsg(image, header=header)
    assert (message.height, message.width, message.encoding, message.step) == (2, 3, "32FC1", 12)
    assert (message.header.frame_id, message.is_bigendian) == ("camera", 0)
    assert bytes(message.data) == struct.pack("<6f", *range(6))
    assert bridge.cv2_to_imgmsg(PIXELS, "rgb8").encoding == "rgb8"
    assert bridge.cv2_to_imgmsg(PIXELS).encoding == "8UC3"
    assert bridge.cv2_to_imgmsg(image.astype(">f4")).is_bigendian == 1


def as_encoding(image, source, target):
    return bridge.imgmsg_to_cv2(bridge.cv2_to_imgmsg(np.ascontiguousarray(image), source), target)


def test_grey_values_are_opencvs():
    assert as_encoding(PIXELS, "bgr8", "mono8").tolist() == [[29, 150, 76, 22, 53, 128]]
    assert as_encoding(PIXELS, "rgb8", "mono8").tolist() == [[76, 150, 29, 18, 85, 128]]
    deep = np.array([[[65535, 0, 0], [0, 65535, 0], [0, 0, 65535], [1000, 20000, 30000]]], dtype=np.uint16)
    assert as_encoding(deep, "bgr16", "mono16").tolist() == [[7470, 38469, 19596, 20824]]


def test_colours_and_depths():
    pixel = np.array([[[1, 2, 3]]], dtype=np.uint8)
    assert as_encoding(pixel, "rgb8", "bgr8").tolist() == [[[3, 2, 1]]]
    assert as_encoding(pixel, "rgb8", "bgra8").tolist() == [[[3, 2, 1, 255]]]
    assert as_encoding(as_encoding(pixel, "rgb8", "bgra8"), "bgra8", "rgb8").tolist() == [[[1, 2, 3]]]
    assert as_encoding(pixel[..., 0], "mono8", "rgb8").tolist() == [[[1, 1, 1]]]
    assert as_encoding(pixel, "rgb8", "bgr16").tolist() == [[[3 * 257, 2 * 257, 257]]]
    deep = np.array([[0, 128, 129, 65535]], dtype=np.uint16)
    assert as_encoding(deep, "mono16", "mono8").tolist() == [[0, 0, 1, 255]]  # rounded, of 65535 / 255
    assert as_encoding(deep, "16UC1", "32FC1").tolist() == [[0.0, 128.0, 129.0, 65535.0]]


@pytest.mark.parametrize(
    ("source", "target", "text"),
    [
        ("16UC1", "mono16", r"\[16UC1\] is not converted into \[mono16\]"),
        ("8UC1", "rgb8", r"\[8UC1\] is not converted into \[rgb8\]"),
        ("mono8", "8UC3", r"\[mono8\] is not converted into \[8UC3\]"),
        ("mono8", "bgr9", r"Unrecognized image encoding \[bgr9\]"),
        ("bayer_rggb8", "rgba8", r"Unsupported conversion from \[bayer_rggb8\] to \[rgba8\]"),
    ],
)
def test_what_is_not_converted(source, target, text):
    image = np.zeros((2, 2), dtype="uint16" if "16" in source else "uint8")
    with pytest.raises(CvBridgeError, match=text):
        as_encoding(image, source, target)


def test_what_is_refused():
    with pytest.raises(CvBridgeError, match="specified as mono8, but image has incompatible type 8UC3"):
        bridge.cv2_to_imgmsg(PIXELS, "mono8")
    with pytest.raises(CvBridgeError, match="an image of int64 has no encoding"):
        bridge.cv2_to_imgmsg(np.zeros((2, 2), dtype=np.int64))
    with pytest.raises(TypeError, match="list is not a NumPy array"):
        bridge.cv2_to_imgmsg([[1]])
    with pytest.raises(CvBridgeError, match="too short: 5 bytes in rows of 3 for 2 x 2 mono8"):
        bridge.imgmsg_to_cv2(Image(height=2, width=2, encoding="mono8", step=3, data=b"12345"))
    with pytest.raises(CvBridgeError, match="cannot be read"):
        bridge.compressed_imgmsg_to_cv2(SimpleNamespace(data=b"nothing"))
    with pytest.raises(CvBridgeError, match="unknown format 'gif2'; it may be bmp, dib"):
        bridge.cv2_to_compressed_imgmsg(PIXELS, "gif2")


def test_bayer_images_need_opencv(monkeypatch):
    """OpenCV's name of a pattern is that of its second row's second pixel; RGGB is its BG."""
    monkeypatch.setitem(sys.modules, "cv2", None)
    image = np.zeros((2, 2), dtype=np.uint8)
    with pytest.raises(CvBridgeError, match="needs OpenCV: pip install opencv-python-headless"):
        as_encoding(image, "bayer_rggb8", "bgr8")
    opencv = SimpleNamespace(COLOR_BayerBG2BGR=48, cvtColor=lambda image, code: np.full((*image.shape, 3), code))
    monkeypatch.setitem(sys.modules, "cv2", opencv)
    assert as_encoding(image, "bayer_rggb8", "bgr8")[0, 0].tolist() == [48, 48, 48]


@pytest.mark.parametrize(
    ("data", "wanted"),
    [
        (COLOUR_PNG, [[[1, 2, 3], [4, 5, 6]]]),
        (DEPTH_PNG, [[1, 65535]]),
        (CLEAR_PNG, [[[1, 2, 3, 4]]]),
    ],
)
def test_compressed_images_that_opencv_has_written(data, wanted):
    assert bridge.compressed_imgmsg_to_cv2(SimpleNamespace(data=bytes.fromhex(data))).tolist() == wanted


def test_compressed_images_go_there_and_back():
    message = bridge.cv2_to_compressed_imgmsg(PIXELS, "png")
    assert (message.format, bytes(message.data[:4])) == ("png", b"\x89PNG")
    assert bridge.compressed_imgmsg_to_cv2(message).tolist() == PIXELS.tolist()
    assert bridge.compressed_imgmsg_to_cv2(message, "rgb8").tolist() == PIXELS[..., ::-1].tolist()
    grey = np.linspace(0, 255, 64, dtype=np.uint8).reshape(8, 8)
    found = bridge.compressed_imgmsg_to_cv2(bridge.cv2_to_compressed_imgmsg(grey)).astype(int)
    assert np.abs(found - grey).max() <= 3  # JPEG of quality 95


def test_opencvs_numbers_of_types():
    """CV_MAKETYPE of OpenCV 4: the depth and eight times the channels less one."""
    assert [getCvType(name) for name in ("8UC1", "mono16", "bgr8", "rgba8", "32FC1", "64FC4")] == [0, 2, 16, 24, 5, 30]
    assert bridge.encoding_to_dtype_with_channels("bgra16") == ("uint16", 4)
    assert bridge.dtype_with_channels_to_cvtype2(np.dtype("int16"), 2) == "16SC2"
    assert bridge.cvtype_to_name[16] == "8UC3"
