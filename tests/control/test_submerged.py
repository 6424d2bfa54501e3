"""Volumes below a surface beside closed forms: prisms, caps, wholes, and surfaces that enclose nothing."""

from math import pi

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drake_twin.control.submerged import (
    SubmergedSolids,
    box_triangles,
    capsule_triangles,
    cylinder,
    ellipsoid,
    is_closed,
    surface,
)

UP = np.array([[0.0, 0.0, 1.0]])
R = Rotation.from_euler("xyz", [0.4, -0.7, 1.1]).as_matrix()
CENTER = np.array([0.3, -0.2, 0.5])


def below(solid, height, up=UP):
    """Volume and center of what is below a surface that is so far below the body's origin."""
    (volume,), (moment,) = SubmergedSolids([solid]).below(up, np.array([height]))
    return volume, moment / volume if volume else None


@pytest.mark.parametrize(
    ("triangles", "volume"),
    [
        (box_triangles((1.0, 2.0, 3.0)), 6.0),
        (capsule_triangles(0.5, 1.0), pi * (0.25 + 1 / 6)),
    ],
)
def test_a_turned_surface_has_its_volume_and_the_halves_have_half_of_it(triangles, volume):
    solid = surface(triangles @ R.T + CENTER)
    assert solid.volume == pytest.approx(volume, rel=1e-12)
    assert solid.center == pytest.approx(CENTER)
    for height, part in ((-9.0, 1.0), (-CENTER[2], 0.5), (9.0, 0.0)):
        assert below(solid, height)[0] == pytest.approx(part * volume, rel=1e-9, abs=1e-12)
    low, high = below(solid, -CENTER[2])[1], below(solid, CENTER[2], -UP)[1]
    assert (low + high) / 2 == pytest.approx(CENTER)
    assert low[2] < CENTER[2] < high[2]


def test_an_upright_box_is_below_by_its_draught():
    volume, center = below(surface(box_triangles((1.0, 2.0, 3.0)) + CENTER), -CENTER[2] + 0.7)
    assert volume == pytest.approx(2 * 0.8)
    assert center == pytest.approx((CENTER[0], CENTER[1], CENTER[2] - 1.5 + 0.4))


def test_a_box_on_its_edge_is_below_as_a_triangle():
    """A square section of side 1, on its edge, with that edge 0.3 below the surface: a triangle of that height."""
    turned = Rotation.from_euler("x", pi / 4).as_matrix()
    volume, center = below(surface(box_triangles((2.0, 1.0, 1.0)) @ turned.T), np.sqrt(0.5) - 0.3)
    assert volume == pytest.approx(2 * 0.3**2)
    assert center == pytest.approx((0, 0, -np.sqrt(0.5) + 0.2))


def test_a_lying_cylinder_is_below_by_the_segment_of_its_circle():
    lying = Rotation.from_euler("y", pi / 2).as_matrix()
    depth, radius = 0.2, 0.5
    angle = np.arccos(1 - depth / radius)
    volume, center = below(cylinder(radius, 2.0, lying, CENTER), radius - depth - CENTER[2])
    area = radius**2 * (angle - np.sin(angle) * np.cos(angle))
    assert volume == pytest.approx(2 * area, rel=1e-12)
    assert center - CENTER == pytest.approx((0, 0, -2 / 3 * radius**3 * np.sin(angle) ** 3 / area), rel=1e-12, abs=1e-9)


@pytest.mark.parametrize("turn", [0.0, 1e-14, 1e-9, pi], ids="{:g}".format)
def test_an_upright_cylinder_is_below_by_its_draught(turn):
    upright = Rotation.from_euler("x", turn).as_matrix()
    volume, center = below(cylinder(0.5, 2.0, upright, CENTER), 0.3 - CENTER[2])
    assert volume == pytest.approx(pi / 4 * 0.7, rel=1e-9)
    assert center - CENTER == pytest.approx((0, 0, -0.65), abs=1e-8)


@pytest.mark.parametrize("height", [-0.9, -0.3, 0.0, 0.4, 1.0])
@pytest.mark.parametrize("turn", [1e-5, 0.2, 1.0, 1.4, pi / 2 - 1e-4, pi / 2 - 1e-9, 2.0, 3.0], ids="{:.4g}".format)
def test_a_tilted_cylinder_is_below_as_a_prism_of_many_sides_is(height, turn):
    tilted = Rotation.from_euler("zx", [0.6, turn]).as_matrix()
    volume, center = below(cylinder(0.5, 2.0, tilted, CENTER), height - CENTER[2])
    angles = np.linspace(0, 2 * pi, 3000, endpoint=False)
    circle = 0.5 * np.column_stack([np.cos(angles), np.sin(angles)])
    low, high = (np.column_stack([circle, np.full(len(circle), z)]) for z in (-1.0, 1.0))
    after, above = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
    middles = [np.broadcast_to([0.0, 0.0, z], low.shape) for z in (-1.0, 1.0)]
    sides = [[low, after, above], [low, above, high], [middles[0], after, low], [middles[1], high, above]]
    prism = np.concatenate([np.stack(corners, axis=1) for corners in sides])
    other, middle = below(surface(prism @ tilted.T + CENTER), height - CENTER[2])
    assert volume == pytest.approx(other, rel=1e-5, abs=1e-9)
    assert other < 1e-3 or center == pytest.approx(middle, abs=1e-5)


def test_a_cylinder_in_water_is_its_whole_and_above_it_none():
    tilted = cylinder(0.5, 2.0, R, CENTER)
    volume, center = below(tilted, -5.0)
    assert (volume, center) == (pytest.approx(pi / 2), pytest.approx(CENTER))
    assert below(tilted, 5.0) == (0.0, None)
    assert below(tilted, -CENTER[2])[0] == pytest.approx(pi / 4, rel=1e-9)
    assert cylinder(0.0, 2.0, R, CENTER) is None
    assert cylinder(0.5, 0.0, R, CENTER) is None


@pytest.mark.parametrize("immersed", [0.1, 0.5, 0.9])
def test_a_sphere_is_below_by_its_cap(immersed):
    volume, center = below(ellipsoid((0.5, 0.5, 0.5), R, CENTER), 0.5 - immersed - CENTER[2])
    assert volume == pytest.approx(pi * immersed**2 * (1.5 - immersed) / 3)
    assert center[2] - CENTER[2] == pytest.approx(-3 * (1 - immersed) ** 2 / (4 * (1.5 - immersed)))


def test_an_ellipsoid_is_below_as_a_surface_of_many_triangles_is():
    """Independently: the sphere's triangles, stretched."""
    axes = np.array([1.0, 0.5, 0.3])
    sphere = capsule_triangles(1.0, 1e-9)
    volume, center = below(ellipsoid(axes, R, CENTER), -0.4)
    other, middle = below(surface(sphere * axes @ R.T + CENTER), -0.4)
    assert volume == pytest.approx(other, rel=5e-3)
    assert center == pytest.approx(middle, rel=5e-3, abs=2e-3)


def test_an_inverted_surface_is_turned_and_an_empty_one_has_no_volume():
    box = box_triangles((1.0, 1.0, 1.0))
    assert surface(box[:, ::-1]).volume == pytest.approx(1.0)
    assert surface(np.concatenate([box[:2], box[:2, ::-1]])) is None
    assert surface(np.zeros((0, 3, 3))) is None


def test_a_surface_is_closed_if_each_edge_has_its_partner():
    vertices = np.eye(4)[:, :3]
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    assert is_closed(vertices, faces)
    assert not is_closed(vertices, faces[:3])
    assert not is_closed(vertices, np.vstack([faces[:3], faces[3:, ::-1]]))
