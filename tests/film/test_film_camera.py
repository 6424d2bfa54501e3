"""A film's camera: all robots in the picture, at rest while they are."""

from itertools import pairwise, product

import numpy as np
import pytest

from drake_twin.film.camera import Camera, Shot

SIZE = (320, 180)


def box(x, y=0.0, half=0.5):
    """The corners of a cube on the ground."""
    return np.array([[x + i * half, y + j * half, half + k * half] for i, j, k in product((-1, 1), repeat=3)])


def places(shot: Shot, points):
    """Where points are in the picture (pixels from its middle), as a camera without distortion sees them."""
    inside = (points - shot.position) @ shot.rotation
    assert (inside[:, 2] > 0).all()
    return shot.focal * inside[:, :2] / inside[:, 2:]


@pytest.mark.parametrize("corners", [box(0), np.vstack([box(0), box(40, 7)]), box(3, half=0.01)])
def test_the_first_picture_shows_all_robots_and_they_fill_it(corners):
    shot = Camera(SIZE, 30).shot(corners)
    share = np.abs(places(shot, corners)).max(axis=0) / (np.array(SIZE) / 2)
    assert (share < 0.85).all()
    assert share.max() > 0.5 or shot.distance < 0.5


def test_the_camera_stands_still_while_a_robot_moves_within_the_picture():
    camera = Camera(SIZE, 30)
    first = camera.shot(box(0))
    assert all(camera.shot(box(0.01 * step)) == first for step in range(1, 10))


def test_the_camera_follows_without_jumps_a_robot_that_leaves():
    camera = Camera(SIZE, 30)
    shots = [(camera.shot(box(x)), box(x)) for x in np.arange(0, 10, 0.4 / 30)]  # 0.4 m/s
    for shot, corners in shots:
        assert (np.abs(places(shot, corners)) < np.array(SIZE) / 2).all()
    assert max(np.linalg.norm(two[0].position - one[0].position) for one, two in pairwise(shots)) < 0.2
    assert shots[-1][0].target[0] == pytest.approx(10, abs=1)


def test_a_world_without_robots_has_a_picture_too():
    assert Camera(SIZE, 30).shot(np.zeros((0, 3))).distance > 1
