"""Hulls: their sides, and those on which they stand."""

import numpy as np
import pytest

from drake_twin.description.hull import planes_of, sides_under


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
