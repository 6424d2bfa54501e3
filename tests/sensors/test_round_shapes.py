"""Distances to round shapes that are known without a formula: along axes, through ends, past rims."""

from math import inf, sqrt

import numpy as np
import pytest
from pydrake.geometry import Capsule, Cylinder, Ellipsoid, Sphere

from drake_twin.sensors.round_shapes import distances, radius_of, sizes_of

BALL, EGG, CAN, PILL = Sphere(1.0), Ellipsoid(2.0, 1.0, 0.5), Cylinder(0.5, 2.0), Capsule(0.5, 2.0)


def met(shape, origin, toward, nearest=0.0, **options):
    """How far a ray goes, toward a point or along a direction of any length."""
    way = np.array(toward, dtype=float)
    (found,) = distances(
        type(shape),
        np.array([sizes_of(shape)]),
        np.array([origin], dtype=float),
        (way / np.linalg.norm(way))[np.newaxis],
        nearest,
        **options,
    )
    return found


@pytest.mark.parametrize(
    ("shape", "origin", "way", "expected"),
    [
        (BALL, (-3, 0, 0), (1, 0, 0), 2.0),
        (BALL, (-3, 0.6, 0), (1, 0, 0), 2.2),  # 0.6² + 0.8² = 1
        (BALL, (-3, 1.1, 0), (1, 0, 0), inf),
        (BALL, (3, 0, 0), (1, 0, 0), inf),
        (BALL, (0.5, 0, 0), (1, 0, 0), 0.5),
        (BALL, (0.5, 0, 0), (-1, 0, 0), 1.5),
        (BALL, (-1e7, 0, 0), (1, 0, 0), 1e7 - 1.0),
        (EGG, (-3, 0, 0), (1, 0, 0), 1.0),
        (EGG, (0, 3, 0), (0, -1, 0), 2.0),
        (EGG, (0, 0, -3), (0, 0, 1), 2.5),
        (CAN, (-2, 0, 0.9), (1, 0, 0), 1.5),
        (CAN, (-2, 0, 1.1), (1, 0, 0), inf),
        (CAN, (0.3, 0, 3), (0, 0, -1), 2.0),
        (CAN, (0.3, 0, -4), (0, 0, 1), 3.0),
        (CAN, (0.6, 0, 3), (0, 0, -1), inf),
        (CAN, (0, 0, 2), (0.4, 0, -1), sqrt(1.16)),  # through its upper end
        (CAN, (0, 0, 2), (0.6, 0, -1), inf),  # over its rim
        (CAN, (0, 0, 0.4), (0, 0, 1), 0.6),
        (PILL, (-2, 0, 0.9), (1, 0, 0), 1.5),
        (PILL, (0, 0, 3), (0, 0, -1), 1.5),
        (PILL, (0.3, 0, 3), (0, 0, -1), 1.6),  # 0.3² + 0.4² = 0.5²
        (PILL, (0, 0.3, -4), (0, 0, 1), 2.6),
        (PILL, (-2, 0, 1.3), (1, 0, 0), 1.6),
        (PILL, (-2, 0, 1.6), (1, 0, 0), inf),
        (PILL, (0, 0, 0.5), (0, 0, -1), 2.0),
    ],
)
def test_a_ray_meets_a_shape_where_it_is(shape, origin, way, expected):
    assert met(shape, origin, way) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("shape", "near", "far"), [(BALL, 2.0, 4.0), (CAN, 2.5, 3.5), (PILL, 2.5, 3.5)])
def test_what_is_nearer_is_not_seen(shape, near, far):
    origin, way = (-3, 0, 0), (1, 0, 0)
    assert met(shape, origin, way, nearest=near) == near
    assert met(shape, origin, way, nearest=near + 0.1) == far  # from inside
    assert met(shape, origin, way, nearest=near + 0.1, from_inside=False) == inf
    assert met(shape, origin, way, nearest=far + 0.1) == inf


@pytest.mark.parametrize("shape", [BALL, EGG, CAN, PILL])
def test_from_inside_a_shape_that_has_no_back_nothing_is_seen(shape):
    assert met(shape, (0.1, 0, 0), (1, 2, 3), from_inside=False) == inf
    assert met(shape, (0.1, 0, 0), (1, 2, 3)) < 2.0


def test_many_pairs_are_as_each_alone():
    generator = np.random.default_rng(1)
    origins, ways = generator.uniform(-2, 2, (50, 3)), generator.normal(size=(50, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, np.newaxis]
    shapes = [Cylinder(*generator.uniform(0.2, 2.0, 2)) for _ in origins]
    together = distances(Cylinder, np.array([sizes_of(shape) for shape in shapes]), origins, ways, 0.0)
    assert np.isfinite(together).any()
    assert np.isinf(together).any()
    assert together == pytest.approx([met(*each) for each in zip(shapes, origins, ways, strict=True)], rel=1e-12)


@pytest.mark.parametrize(("shape", "radius"), [(BALL, 1.0), (EGG, 2.0), (Cylinder(0.3, 0.8), 0.5), (PILL, 1.5)])
def test_the_sphere_about_a_shape_is_the_least(shape, radius):
    assert radius_of(shape) == pytest.approx(radius, rel=1e-15)
