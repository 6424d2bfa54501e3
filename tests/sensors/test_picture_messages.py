"""Messages of pictures, byte by byte, against the encodings of ROS's image_encodings.hpp and ITU-R BT.601."""

import numpy as np
import pytest

from drake_twin import messages
from drake_twin.sensors.cameras.picture_messages import cloud, color_image, depth_image, pixels

HEADER = messages.header(0.0, "lens")
RED, GREEN, BLUE, WHITE = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255)
FOUR = np.array([[RED, GREEN], [BLUE, WHITE]], dtype=np.uint8)


def points(message):
    """The rows x, y, z of a cloud, and its colors."""
    data = np.asarray(message.data).reshape(-1, message.point_step)
    offsets = {field.name: field.offset for field in message.fields}
    columns = {
        name: data[:, at : at + 4].copy().view("<u4" if name == "rgb" else "<f4") for name, at in offsets.items()
    }
    return np.column_stack([columns[name] for name in "xyz"]).tolist(), columns["rgb"].ravel().tolist()


@pytest.mark.parametrize(
    ("encoding", "expected"),
    [
        ("rgb8", [*RED, *GREEN, *BLUE, *WHITE]),
        ("bgr8", [*BLUE, *GREEN, *RED, *WHITE]),
        ("mono8", [76, 150, 29, 255]),  # 0.299, 0.587 and 0.114 of 255, rounded
        ("bayer_rggb8", [255, 255, 0, 255]),  # at each place the channel of its filter alone
        ("bayer_bggr8", [0, 255, 0, 255]),
        ("bayer_gbrg8", [0, 0, 0, 255]),
    ],
)
def test_colors_in_each_encoding(encoding, expected):
    message = color_image(HEADER, encoding, FOUR)
    assert message.data.tolist() == expected
    assert (message.height, message.width, message.step) == (2, 2, len(expected) // 2)
    assert (message.encoding, message.is_bigendian, message.header.frame_id) == (encoding, 0, "lens")


def test_16_bits_of_gray_have_the_whole_range():
    message = color_image(HEADER, "mono16", FOUR)
    found = pixels(message)
    assert found.dtype == np.uint16
    assert found == pytest.approx(np.array([[0.299, 0.587], [0.114, 1.0]]) * 65535, abs=0.5)
    assert message.step == 4


def test_depths_are_floats_row_by_row():
    depth = np.array([[1.0, np.inf, -np.inf], [0.25, 3.0, 4.0]], dtype=np.float32)
    message = depth_image(HEADER, depth)
    assert (message.height, message.width, message.step, message.encoding) == (2, 3, 12, "32FC1")
    assert message.data.tobytes() == depth.tobytes()
    assert pixels(message).tolist() == depth.tolist()


@pytest.mark.parametrize(
    ("is_optical", "expected"),
    [
        (True, [[0.5, -1.0, 2.0], [-4.0, 1.0, 4.0], [np.inf] * 3, [-np.inf] * 3]),  # x to the right, y down
        (False, [[2.0, -0.5, 1.0], [4.0, 4.0, -1.0], [np.inf] * 3, [-np.inf] * 3]),  # x ahead, y to the left, z up
    ],
)
def test_points_are_where_their_pixels_look(is_optical, expected):
    slopes = (np.array([[0.25, -1.0], [1.0, 1.0]]), np.array([[-0.5, 0.25], [1.0, 1.0]]))  # to the right, down
    depth = np.array([[2.0, 4.0], [np.inf, -np.inf]])
    message = cloud(HEADER, slopes, depth, FOUR, is_optical=is_optical)
    xyz, colors = points(message)
    assert xyz == expected
    assert colors == [0xFF0000, 0x00FF00, 0x0000FF, 0xFFFFFF]
    assert (message.height, message.width) == (2, 2)
    assert message.point_step == (32 if is_optical else 16)
    assert message.row_step == 2 * message.point_step
    assert not message.is_dense
    assert cloud(HEADER, slopes, np.ones((2, 2)), FOUR, is_optical=is_optical).is_dense
