from types import SimpleNamespace

import numpy as np
import pytest
import umsgpack
from pydrake.geometry import Box, Mesh

from drake_twin.shared_viewer.frame_sender import Frame, FrameSender
from drake_twin.shared_viewer.shared_scene import DrawnGeometry

RED = (1.0, 0.0, 0.0, 1.0)


def scene(*robots, side=1.0, color=RED):
    """A box on the one body of each robot."""
    return SimpleNamespace(
        bodies=tuple(f"{robot}/base" for robot in robots),
        geometries=tuple(
            DrawnGeometry(f"{robot}/base/box", Box(side, side, side), color, np.eye(4)) for robot in robots
        ),
    )


def poses(*heights):
    matrices = np.tile(np.eye(4), (len(heights), 1, 1))
    matrices[:, 2, 3] = heights
    return matrices


def sent(sender, *frame):
    """What is sent for a frame: kind and path of each command."""
    return [(kind.decode(), path.decode()) for kind, path, _ in sender.commands(Frame(*frame))]


def test_the_first_frame_clears_the_folder_and_sends_all_of_it():
    assert sent(FrameSender("/f"), scene("a", "b"), poses(0, 0)) == [
        ("delete", "/f"),
        ("set_object", "/f/a/base/box"),
        ("set_object", "/f/b/base/box"),
        ("set_transform", "/f/a/base"),
        ("set_transform", "/f/b/base"),
    ]


def test_only_what_moved_is_sent():
    sender, robots = FrameSender("/f"), scene("a", "b")
    sent(sender, robots, poses(0, 0))
    assert sent(sender, robots, poses(0, 0.1)) == [("set_transform", "/f/b/base")]
    assert sender.transforms == 1
    assert sent(sender, robots, poses(0, 0.1)) == []


def test_what_creeps_is_sent_once_it_has_come_far_enough():
    sender, robots = FrameSender("/f"), scene("a")
    sent(sender, robots, poses(0))
    counts = [len(sent(sender, robots, poses(4e-7 * step))) for step in range(1, 7)]
    assert counts == [0, 0, 1, 0, 0, 1]


def test_a_matrix_travels_column_by_column():
    sender, robots = FrameSender("/f"), scene("a")
    matrix = np.arange(16.0).reshape(1, 4, 4)
    *_, (_, _, data) = sender.commands(Frame(robots, matrix))
    command = umsgpack.unpackb(data)
    assert command == {"type": "set_transform", "path": "/f/a/base", "matrix": matrix[0].T.ravel().tolist()}


def test_when_a_robot_comes_or_goes_the_others_are_not_drawn_anew():
    sender = FrameSender("/f")
    sent(sender, scene("a", "b"), poses(0, 0))
    assert sent(sender, scene("b", "c"), poses(0, 0)) == [
        ("delete", "/f/a"),
        ("set_object", "/f/c/base/box"),
        ("set_transform", "/f/b/base"),
        ("set_transform", "/f/c/base"),
    ]


@pytest.mark.parametrize("changed", [{"side": 2.0}, {"color": (0.0, 1.0, 0.0, 1.0)}])
def test_a_geometry_that_looks_different_is_sent_anew(changed):
    sender = FrameSender("/f")
    sent(sender, scene("a"), poses(0))
    assert ("set_object", "/f/a/base/box") in sent(sender, scene("a", **changed), poses(0))


def test_a_mesh_that_cannot_be_read_is_named_and_the_rest_is_shown(tmp_path, caplog):
    file = tmp_path / "empty.obj"
    file.write_text("v 0 0 0\n")
    robots = scene("a")
    broken = DrawnGeometry("a/base/mesh", Mesh(file), RED, np.eye(4))
    robots.geometries = (broken, *robots.geometries)
    assert ("set_object", "/f/a/base/box") in sent(FrameSender("/f"), robots, poses(0))
    assert "the shared page does not show a/base/mesh: it has no triangles" in caplog.text
