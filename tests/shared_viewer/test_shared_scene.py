import gc
from types import ModuleType

import numpy as np
import pytest
from conftest import ARM, ROVER, rovers
from pydrake.geometry import Box

from drake_twin import TwinBuilder
from drake_twin.shared_viewer.shared_scene import SharedScene

CRATE = """<robot name="crate">
  <material name="green"><color rgba="0 1 0 0.5"/></material>
  <link name="base">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual name="lid"><origin xyz="0 0 0.3"/><geometry><box size="1 2 3"/></geometry><material name="green"/></visual>
    <visual name="a/b"><geometry><sphere radius="1"/></geometry></visual>
    <collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>
  </link>
</robot>"""


@pytest.fixture
def crate(tmp_path):
    file = tmp_path / "crate.urdf"
    file.write_text(CRATE)
    return TwinBuilder().robot("c", file, xyz=(1, 2, 3)).build()


def test_it_holds_what_is_to_be_seen_with_size_color_and_place(crate):
    scene = SharedScene(crate)
    drawn = {geometry.path: geometry for geometry in scene.geometries}
    assert list(drawn) == ["c/base/lid", "c/base/a_b", "world/ground"]
    lid = drawn["c/base/lid"]
    assert isinstance(lid.shape, Box)
    assert (lid.shape.width(), lid.shape.depth(), lid.shape.height()) == (1, 2, 3)
    assert lid.color == (0, 1, 0, 0.5)
    assert lid.X_BG[:3, 3] == pytest.approx([0, 0, 0.3])


def test_poses_are_those_of_the_present_time(crate):
    scene = SharedScene(crate)
    start = scene.poses(crate)
    assert scene.bodies == ("c/base",)
    assert start[0][:3, 3] == pytest.approx([1, 2, 3])
    crate.advance_to(0.1)
    assert scene.poses(crate)[0][2, 3] < start[0][2, 3] - 0.01  # it falls
    assert start[0][:3, 3] == pytest.approx([1, 2, 3])


def test_robots_of_one_file_have_folders_of_their_own():
    scene = SharedScene(rovers(2).build())
    assert {body.partition("/")[0] for body in scene.bodies} == {"robot_1", "robot_2"}
    assert len(scene.bodies) == len(set(scene.bodies)) == 10
    assert len({geometry.path for geometry in scene.geometries}) == len(scene.geometries)


def test_a_scene_is_one_twins_and_no_others():
    first, second = rovers(1).build(), rovers(1).build()
    scene = SharedScene(first)
    assert scene.shows(first)
    assert not scene.shows(second)


def test_a_scene_keeps_no_diagram_alive():
    """What is in the way of freeing a diagram that was replaced is in the way of spawning for hours."""
    twin = TwinBuilder().robot("arm", ARM).build()
    scene = SharedScene(twin)
    seen, waiting = set(), [scene]
    while waiting:
        item = waiting.pop()
        if id(item) not in seen and not isinstance(item, type | ModuleType):
            seen.add(id(item))
            waiting += gc.get_referents(item)
    assert id(twin.diagram) not in seen
    assert id(twin.plant) not in seen


def test_a_twin_without_robots_to_move_has_no_poses(tmp_path):
    file = tmp_path / "wall.urdf"
    file.write_text(
        '<robot name="wall"><link name="world"/><link name="w"><visual><geometry><box size="1 1 1"/></geometry>'
        '</visual></link><joint name="j" type="fixed"><parent link="world"/><child link="w"/></joint></robot>'
    )
    twin = TwinBuilder().robot("wall", file).robot("rover", ROVER, xyz=(3, 0, 0.13)).build()
    scene = SharedScene(twin)
    poses = scene.poses(twin)
    assert poses.shape == (len(scene.bodies), 4, 4)
    assert np.isfinite(poses).all()
