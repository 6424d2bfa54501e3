"""What the process that draws hands back of a scene, against distances along the axis."""

import numpy as np
import pytest
from camera_rig import need_mesa
from pydrake.math import RigidTransform, RollPitchYaw

from drake_twin.sensors.cameras.picture import View
from drake_twin.sensors.cameras.renderer import Renderer
from drake_twin.sensors.cameras.scene import SeenScene, SeenShape

SIZE = 33  # an odd number of pixels, so that one is in the middle
OPTICAL = RigidTransform(RollPitchYaw(-np.pi / 2, 0, -np.pi / 2), [0, 0, 0])  # looks along x


def box(place, color, label, moves=None):
    pose = tuple(RigidTransform(place).GetAsMatrix34().ravel().tolist())
    return SeenShape("box", (1.0, 1.0, 1.0), "", "", color, moves, pose, label)


def drawn(renderer, scene, kind, *bodies, near=0.1):
    poses = np.array([pose.GetAsMatrix34() for pose in (*bodies, OPTICAL)])
    view = View(kind, SIZE, SIZE, (20.0, 20.0, 16.0, 16.0), near, 50.0)
    picture = renderer.ask("camera", scene, view, poses).wait()
    assert picture is not None, renderer.findings
    return picture


@pytest.fixture
def renderer():
    need_mesa()
    found = Renderer()
    yield found
    found.close()


def test_shapes_are_where_they_stand_or_move(renderer):
    scene = SeenScene((box([5, 0, 0], (1, 0, 0, 1), 3), box([0, 0, 2], (0, 1, 0, 1), 8, moves=0)), (8,))
    aside, before = RigidTransform([5.0, 3.0, -2.0]), RigidTransform([3.0, 0, -2.0])
    depth = drawn(renderer, scene, "depth", aside)
    assert depth[16, 16] == pytest.approx(4.5, rel=1e-4)  # the side of the box that stands
    assert depth[16, 4] == pytest.approx(4.5, rel=1e-4)  # 3 m to the left of it is the box that moves
    assert np.isposinf(depth[16, 28])
    labels = drawn(renderer, scene, "label", aside)
    assert (labels[16, 16], labels[16, 4], labels[0, 0]) == (3, 8, 0)
    assert drawn(renderer, scene, "depth", before)[16, 16] == pytest.approx(2.5, rel=1e-4)
    color = drawn(renderer, scene, "color", before)[16, 16].astype(int)
    assert color[1] > 50 + color[0]
    assert renderer.asked == 4


def test_what_is_too_near_is_minus_infinity(renderer):
    scene = SeenScene((box([5, 0, 0], (1, 0, 0, 1), 1),), ())
    assert np.isneginf(drawn(renderer, scene, "depth", near=4.6)[16, 16])
    assert drawn(renderer, scene, "depth", near=4.4)[16, 16] == pytest.approx(4.5, rel=1e-4)
