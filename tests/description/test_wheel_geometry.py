import numpy as np
import pytest
from pydrake.math import RigidTransform, RollPitchYaw
from urdf_text import parse_urdf

from drake_twin.description.wheel_geometry import wheel_centers, wheel_radius


def robot(geometry='<box size="1 1 1"/>', rpy="0.3 -0.2 1.1"):
    return parse_urdf(
        '<robot name="r"><link name="base"/><link name="fork"/><link name="wheel"><collision><geometry>'
        f"{geometry}</geometry></collision></link>"
        f'<joint name="steer" type="continuous"><parent link="base"/><child link="fork"/>'
        f'<origin xyz="0.5 0.1 0.2" rpy="{rpy}"/></joint>'
        '<joint name="roll" type="continuous"><parent link="fork"/><child link="wheel"/>'
        '<origin xyz="0.1 0.2 -0.3" rpy="1.57 0 0"/></joint></robot>'
    )


def test_a_wheels_center_is_found_through_turned_joints():
    (center,) = wheel_centers(robot(), ["roll"])
    fork = RigidTransform(RollPitchYaw(0.3, -0.2, 1.1), [0.5, 0.1, 0.2])
    np.testing.assert_allclose(center, fork @ [0.1, 0.2, -0.3], atol=1e-15)


@pytest.mark.parametrize(
    ("geometry", "radius"),
    [('<cylinder radius="0.3" length="1"/>', 0.3), ('<sphere radius="0.2"/>', 0.2), ('<box size="1 1 1"/>', None)],
)
def test_a_wheels_radius_is_that_of_its_collision_shape(geometry, radius):
    assert wheel_radius(robot(geometry), "roll") == radius
