"""Hulls: coarse ones of many points, slivers at their corners, their sides, and those on which they stand."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from drake_twin.description import hull
from drake_twin.description.hull import _far_apart as far_apart
from drake_twin.description.hull import corners_of, hull_of, planes_of, sides_under, without_slivers

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])


def tent(height):
    """A cube with a corner above the middle of its lid's edge, at some height above that edge's line."""
    return np.vstack([CUBE, [0.5, 0.0 - height, 1.0]])


def twice_least_area(corners):
    """Twice the area of the smallest triangle of a hull, by Qhull."""
    one, two, three = np.moveaxis(corners[ConvexHull(corners).simplices], 1, 0)
    return float(np.linalg.norm(np.cross(two - one, three - one), axis=1).min())


@pytest.mark.parametrize(("height", "stays"), [(1e-6, False), (1e-5, False), (1e-3, True), (0.1, True)])
def test_a_corner_that_is_almost_on_an_edge_is_removed(height, stays):
    """Twice the area of its triangle with the edge is ``height``, the least a ten-thousandth of the size squared."""
    kept = without_slivers(tent(height))
    assert len(kept) == (9 if stays else 8)
    assert stays or sorted(map(tuple, kept)) == sorted(map(tuple, CUBE))


def test_a_ball_of_very_many_corners_keeps_its_size(monkeypatch):
    points = np.random.default_rng(1).normal(size=(3_000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    monkeypatch.setattr(hull, "_MANY_CORNERS", 1_000)
    monkeypatch.setattr(hull, "_DIRECTIONS", 500)
    asked = []
    monkeypatch.setattr(hull, "_far_apart", lambda corners: asked.append(len(corners)) or far_apart(corners))
    corners, _ = hull_of(points)
    assert asked[0] <= 506
    np.testing.assert_array_equal(np.ptp(corners, axis=0), np.ptp(points, axis=0))


@pytest.mark.parametrize(("least", "count"), [(0.05, 9), (0.2, 8)])
def test_the_least_area_may_be_given(least, count):
    kept = without_slivers(tent(0.1), least)
    assert len(kept) == count
    assert twice_least_area(kept) >= least


def test_the_least_area_is_relative_to_the_hulls_size():
    for size in (1e-3, 1e3):
        assert len(without_slivers(size * tent(1e-5))) == 8
        assert len(without_slivers(size * tent(1e-3))) == 9


def test_a_tetrahedron_stays_however_flat():
    flat = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 1e-7]])
    assert without_slivers(flat, 1.0).shape == (4, 3)


def test_several_slivers_are_removed_one_after_the_other():
    slivers = [[0.5, -1e-6, 1.0], [0.5, -1e-6, 0.0]]
    kept = without_slivers(np.vstack([CUBE, slivers]))
    assert sorted(map(tuple, kept)) == sorted(map(tuple, CUBE))


def test_a_hull_of_many_points_has_few_corners_loses_little_and_keeps_its_box():
    rng = np.random.default_rng(2)
    points = rng.normal(size=(5000, 3))
    points *= np.array([0.3, 0.2, 0.1]) / np.linalg.norm(points, axis=1)[:, None]
    corners, triangles = hull_of(points)
    assert len(corners) <= 64
    assert np.ptp(corners, axis=0) == pytest.approx(np.ptp(points, axis=0))
    assert ConvexHull(corners).volume == pytest.approx(ConvexHull(points).volume, rel=0.15)
    assert twice_least_area(corners) > 1e-4 * 0.6**2 * 0.999
    assert triangles.max() == len(corners) - 1
    few, _ = hull_of(np.vstack([CUBE, rng.uniform(0.1, 0.9, (500, 3))]))
    assert sorted(map(tuple, few)) == sorted(map(tuple, CUBE))


def test_the_planes_of_a_hull_are_its_sides():
    directions, distances = planes_of(CUBE - 0.25)
    assert sorted(map(tuple, np.round(directions * distances[:, None], 9) + 0.0)) == sorted(
        [(0.75, 0, 0), (0, 0.75, 0), (0, 0, 0.75), (-0.25, 0, 0), (0, -0.25, 0), (0, 0, -0.25)]
    )


def test_the_corners_of_a_hull_of_drakes():
    from pydrake.geometry import Convex

    hull = Convex(np.ascontiguousarray(CUBE.T), "cube").GetConvexHull()
    assert sorted(map(tuple, corners_of(hull))) == sorted(map(tuple, CUBE))


def test_the_rounding_of_an_stl_file_does_not_divide_a_side():
    angles = 2 * np.pi * (np.arange(9) + 0.5) / 9
    x, y = np.cos(angles), 0.4 * np.sin(angles)
    rings = [np.column_stack([size * x, size * y, np.full(9, z)]) for size, z in ((1, 0), (0.3, 1))]
    corners = np.vstack(rings)
    normals, _ = planes_of(corners)
    rounded, _ = planes_of(corners.astype(np.float32).astype(float))
    assert len(normals) == len(rounded) == 11


def test_sides_to_stand_on_have_the_area_and_width_of_their_rectangle():
    corners = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-0.2, 0.2) for z in (-0.5, 0.5)])
    sides = sides_under(corners, np.array([0.3, 0.0, 0.0]))
    found = sorted((side.area, side.width, side.height, side.off) for side in sides)
    assert found == pytest.approx(
        np.array([(0.4, 0.4, 0.7, 0), (0.4, 0.4, 1.3, 0), *2 * [(0.8, 0.4, 0.5, 0.3)], *2 * [(2, 1, 0.2, 0.3)]])
    )
