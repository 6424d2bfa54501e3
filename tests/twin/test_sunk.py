"""Robots that come into the world inside something."""

import pytest
from conftest import rovers

from drake_twin import TwinBuilder
from drake_twin.scenario import Robot, World

CUBE = """<robot name="cube"><link name="body"><inertial><mass value="1"/>
<inertia ixx="7e-3" iyy="7e-3" izz="7e-3" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link></robot>"""
BOX = "<geometry><box><size>1 1 1</size></box></geometry>"
WORLD = f"""<sdf version="1.9"><world name="w">
<model name="wall"><static>true</static><pose>2 0 0.5 0 0 0</pose><link name="bricks">
<collision name="c">{BOX}</collision></link></model>
<model name="crate"><pose>5 5 0.5 0 0 0</pose><link name="wood"><collision name="c">{BOX}</collision></link></model>
</world></sdf>"""


@pytest.fixture
def cube(tmp_path):
    file = tmp_path / "cube.urdf"
    file.write_text(CUBE)
    return str(file)


@pytest.fixture
def world(tmp_path):
    file = tmp_path / "world.sdf"
    file.write_text(WORLD)
    return World(file=str(file), ground=True)


def sunk(twin):
    return [text for text in twin.findings.warnings if "deep" in text]


@pytest.mark.parametrize(
    ("place", "what"),
    [
        ((0, 0, 0.05), "5.0 cm deep in the ground (body)"),
        ((0, 0, 0.0979), "2.1 mm deep in the ground (body)"),
        ((1.45, 0, 0.1), "5.0 cm deep in the world's 'wall' (body in bricks)"),
        ((4.45, 5, 0.1), "5.0 cm deep in the world's 'crate' (body in wood)"),
    ],
)
def test_a_robot_inside_something_says_in_what_and_how_deep(cube, world, place, what):
    twin = TwinBuilder(world=world).robot("a", cube, xyz=(9, 9, 0.1)).robot("b", cube, xyz=place).build()
    assert sunk(twin) == [f"b: it starts {what}: contact pushes it out"]


@pytest.mark.parametrize("place", [(0, 0, 0.1), (0, 0, 0.0995), (1.4, 0, 0.1), (0, 0, 3)])
def test_what_stands_on_the_ground_or_beside_something_is_not_sunk(cube, world, place):
    assert sunk(TwinBuilder(world=world).robot("b", cube, xyz=place).build()) == []


def test_the_rovers_stand_on_the_ground():
    assert sunk(rovers(3).build()) == []


def test_of_two_robots_the_one_that_comes_later_is_named_with_the_other(cube, caplog):
    twin = TwinBuilder().robot("b", cube, xyz=(0, 0, 0.1)).robot("a", cube, xyz=(0.13, 0, 0.1)).build()
    at_start = "a: it starts 7.0 cm deep in robot 'b' (body in body): contact pushes it out"
    assert sunk(twin) == [at_start]
    twin.advance_to(1.0)
    apart = twin.entities.state("a").position[0] - twin.entities.state("b").position[0]
    assert apart == pytest.approx(0.2, abs=5e-3)
    twin.entities.spawn(Robot("c", cube, xyz=(5, 0, 0.1)))
    assert caplog.messages == []
    twin.entities.spawn(Robot("d", cube, xyz=(5.1, 0, 0.1)))
    later = "d: it starts 10.0 cm deep in robot 'c' (body in body): contact pushes it out"
    assert sunk(twin) == [at_start, later]
    assert caplog.messages == [later]
    twin.clock.set_time_step(0.01)
    twin.entities.delete("a")
    assert sunk(twin) == [later]
