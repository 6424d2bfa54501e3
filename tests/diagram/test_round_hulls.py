"""Round hulls roll on two ellipsoids that touch their side from within, and are inside of it elsewhere."""

from itertools import pairwise

import numpy as np
import pytest
from pydrake.geometry import Convex
from pydrake.math import RigidTransform

from drake_twin.description.hull import corners_of
from drake_twin.diagram.round_hulls import round_hull

FRUSTUM = [(0.1, 0.0), (0.05, 0.3)]  # radius and place of each circle (m)
CUP = [(0.03, 0.0), (0.04, 0.01), (0.06, 0.2)]
CONE = [(0.08, 0.0), (0.0, 0.25)]
BOTTLE = [(0.03, 0.0), (0.045, 0.01), (0.05, 0.2), (0.03, 0.24), (0.015, 0.25), (0.014, 0.3)]


def side_of(circles):
    """The circles at the ends of the longest part of an outline, from below."""
    ordered = sorted(circles, key=lambda circle: circle[1])
    return max(pairwise(ordered), key=lambda ends: np.hypot(*np.subtract(*ends)))


def hull(circles, count=48, axis=2):
    angles = 2 * np.pi * np.arange(count) / count
    rings = [np.stack([r * np.cos(angles), r * np.sin(angles), np.full(count, z)], axis=1) for r, z in circles]
    points = np.roll(np.vstack(rings), axis + 1, axis=1)
    return Convex(np.ascontiguousarray(points.T), "round")


def outside(shape, X, normal, offset):
    """How far an ellipsoid reaches beyond a plane normal · x = offset, by its support function (m)."""
    center, half = X.translation(), np.array([shape.a(), shape.b(), shape.c()])
    return float(normal @ center + np.linalg.norm(half * (X.rotation().matrix().T @ normal)) - offset)


@pytest.mark.parametrize("circles", [FRUSTUM, CUP, CONE, BOTTLE, FRUSTUM[::-1], [(0.05, -0.1), (0.05, 0.1)]])
@pytest.mark.parametrize("axis", range(3))
def test_rims_touch_the_side_from_within(circles, axis):
    found = round_hull(hull(circles, axis=axis))
    (r0, z0), (r1, z1) = side_of(circles)
    length = np.hypot(r1 - r0, z1 - z0)
    normal = np.roll([(z1 - z0) / length, 0.0, -(r1 - r0) / length], axis + 1)
    along = np.roll([r0, 0.0, z0], axis + 1)
    rims = found.rims()
    for shape, X in rims:
        assert outside(shape, X, normal, normal @ along) == pytest.approx(0.0, abs=1e-12)
        for end, place in ((-1.0, min(z for _, z in circles)), (1.0, max(z for _, z in circles))):
            assert outside(shape, X, np.roll([0.0, 0.0, end], axis + 1), end * place) < 1e-12
    one, other = (X.translation() for _, X in rims)
    assert np.linalg.norm(one - other) > 0.5 * (z1 - z0)  # at the side's two ends


@pytest.mark.parametrize("circles", [FRUSTUM, BOTTLE])
def test_the_hull_within_is_farther_inside_by_its_recess(circles):
    corners = corners_of(round_hull(hull(circles, count=240)).within(0.004).GetConvexHull())
    places = np.stack([np.hypot(corners[:, 0], corners[:, 1]), corners[:, 2]], axis=1)
    (r0, z0), (r1, z1) = side_of(circles)
    normal = np.array([z1 - z0, r0 - r1]) / np.hypot(z1 - z0, r1 - r0)
    depths = normal @ (r0, z0) - places @ normal
    at_side = (z0 <= places[:, 1]) & (places[:, 1] <= z1)
    assert at_side.sum() >= 48
    assert depths[at_side] == pytest.approx([0.004] * at_side.sum(), abs=1e-9)
    assert depths.min() > 0.004 - 1e-9
    assert (corners[:, 2].min(), corners[:, 2].max()) == (0.0, 0.3)


@pytest.mark.parametrize(
    "shape",
    [
        Convex(np.array([[x, y, z] for x in (0, 0.1) for y in (0, 0.2) for z in (0, 0.3)], dtype=float).T, "box"),
        hull(FRUSTUM, count=8),
        hull([(0.1, 0.0), (0.0, 0.01)]),  # a plate, nearly
    ],
)
def test_other_hulls_are_not_round(shape):
    assert round_hull(shape) is None


def test_the_frame_of_the_axis_is_in_the_hulls_middle():
    points = (RigidTransform([0.2, -0.1, 0.0]) @ corners_of(hull(FRUSTUM).GetConvexHull()).T).T
    found = round_hull(Convex(np.ascontiguousarray(points.T), "round"))
    assert found.X_GA.translation() == pytest.approx([0.2, -0.1, 0.0], abs=1e-9)
    assert (found.radii, found.places) == (pytest.approx((0.1, 0.05)), pytest.approx((0.0, 0.3)))
