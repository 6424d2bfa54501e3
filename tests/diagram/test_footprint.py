import numpy as np
import pytest
from conftest import ROVER

from drake_twin.description.package_index import PackageIndex
from drake_twin.diagram.footprint import footprint
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.scenario import Robot

LINK = """<robot name="r"><link name="base"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<{kind}><origin xyz="0 0 1" rpy="0.3 0.4 0.5"/><geometry>{shape}</geometry></{kind}></link></robot>"""


def of(tmp_path, shape, kind="collision"):
    file = tmp_path / "r.urdf"
    file.write_text(LINK.format(shape=shape, kind=kind))
    return footprint(plan_robot(Robot("r", str(file)), PackageIndex()))


def cloud(points):
    """Points of a surface, turned and moved as the shape is."""
    from pydrake.math import RollPitchYaw, RotationMatrix

    turned = points @ RotationMatrix(RollPitchYaw(0.3, 0.4, 0.5)).matrix().T
    return turned + np.array([0, 0, 1])


@pytest.mark.parametrize(
    ("shape", "points"),
    [
        ('<sphere radius="0.3"/>', lambda a, b: 0.3 * sphere(a, b)),
        ('<box size="0.2 0.4 0.6"/>', lambda a, b: np.sign(sphere(a, b)) * (0.1, 0.2, 0.3)),
        (
            '<cylinder radius="0.2" length="1.0"/>',
            lambda a, b: np.column_stack([0.2 * np.cos(a), 0.2 * np.sin(a), np.where(b > 0, 0.5, -0.5)]),
        ),
    ],
    ids=["sphere", "box", "cylinder"],
)
def test_the_box_touches_the_turned_shape_on_every_side(tmp_path, shape, points):
    angles = np.linspace(0, 2 * np.pi, 400)
    a, b = (grid.ravel() for grid in np.meshgrid(angles, np.linspace(-np.pi / 2, np.pi / 2, 200)))
    surface = cloud(points(a, b))
    room = of(tmp_path, shape)
    assert np.abs(np.array(room.lower) - surface.min(axis=0)).max() < 1e-3
    assert np.abs(np.array(room.upper) - surface.max(axis=0)).max() < 1e-3


def sphere(a, b):
    return np.column_stack([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)])


def test_a_robot_without_collision_shapes_is_as_large_as_it_looks(tmp_path):
    assert of(tmp_path, '<sphere radius="0.3"/>', "visual").upper[2] == pytest.approx(1.3)


def test_the_rovers_wheels_reach_lowest():
    room = footprint(plan_robot(Robot("robot_1", ROVER), PackageIndex()))
    assert room.lower == pytest.approx((-0.29, -0.235, -0.13), abs=1e-6)
