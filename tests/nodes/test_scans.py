"""Scans of depth images and clouds, by geometry and by loops over their pixels and points."""

from math import atan, atan2, ceil, hypot, inf, isfinite, isinf, isnan, nan, pi

import numpy as np
import pytest

from drake_twin.nodes.scans import ranges_of_depths, ranges_of_points

FX, CX, CY = 570.3422241210938, 314.5, 235.5  # of upstream's test
ROWS, COLUMNS = 480, 640
RAYS = (0 - CX) / FX, (COLUMNS - 1 - CX) / FX
KINECT = {"camera": (FX, CX, CY), "rays": RAYS, "limits": (0.45, 10.0)}


def scan(depths, height=1):
    unit = 1.0 if depths.dtype.kind == "f" else 1e-3
    return ranges_of_depths(depths, unit, height=height, **KINECT)


def expected_scan(depths, unit, height):
    """The loop over the pixels, with what is preferred: a near range, then infinity, then nothing."""
    first, last = -atan(RAYS[1]), atan(-RAYS[0])
    step, found = (last - first) / (COLUMNS - 1), [nan] * COLUMNS
    start = int(CY - height / 2)
    for row in depths[start : start + height]:
        for u, depth in enumerate(row.tolist()):
            x = (u - CX) / FX
            place = int((-atan(x) - first) / step + 1e-4)  # the scan's angles are single
            value = depth if not isfinite(depth) or not depth else depth * unit * hypot(x, 1.0)
            old = found[place]
            if (isinf(value) and not isfinite(old)) or (0.45 <= value <= 10.0 and not (isfinite(old) and old <= value)):
                found[place] = value
    return found


def test_a_wall_ahead():
    """A plane at a depth of 3 m has the range 3 m / cos(angle)."""
    first, last, ranges = scan(np.full((ROWS, COLUMNS), 3000, dtype=np.uint16))
    angles = np.linspace(first, last, COLUMNS)
    seen = np.isfinite(ranges)
    assert ranges[seen] == pytest.approx(3.0 / np.cos(angles[seen]), rel=2e-3)
    assert (first, last) == pytest.approx((-atan((639 - CX) / FX), atan(CX / FX)))
    assert seen.mean() > 0.85  # the columns are not equally far apart as angles are


@pytest.mark.parametrize("kind", [np.uint16, np.float32])
@pytest.mark.parametrize("height", [1, 7])
def test_random_images_beside_the_loop(kind, height):
    rng = np.random.default_rng(height)
    depths = rng.uniform(0.2, 12.0, (ROWS, COLUMNS))
    depths = (1000 * depths).astype(kind) if kind is np.uint16 else depths.astype(kind)
    if kind is np.float32:
        for value in (nan, inf, -inf):
            depths[rng.random(depths.shape) < 0.2] = value
    else:
        depths[rng.random(depths.shape) < 0.2] = 0
    _, _, ranges = scan(depths, height)
    expected = np.array(expected_scan(depths, 1e-3 if kind is np.uint16 else 1.0, height))
    # Where a column lies on the edge of two places, single and double precision choose differently.
    differ = ~np.isclose(ranges, expected, rtol=1e-6, equal_nan=True)
    assert differ.mean() < 0.01


@pytest.mark.parametrize("height", [1, 2, 40, 99, 100])
def test_the_nearest_of_each_column(height):
    """``testScanHeight`` of upstream's test/DepthImageToLaserScanTest.cpp."""
    depths = np.zeros((ROWS, COLUMNS), dtype=np.uint16)
    start = int(CY - height / 2.0)
    rows, columns = np.mgrid[:height, :COLUMNS]
    depths[start : start + height] = np.where(rows % height == columns % height, 500, 3000)
    _, _, ranges = scan(depths, height)
    assert (ranges[np.isfinite(ranges)] < 3.0 * 0.9).all()


@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_what_is_no_number_stays_so(value):
    """``testNaN``, ``testPositiveInf`` and ``testNegativeInf`` of upstream's test."""
    _, _, ranges = scan(np.full((ROWS, COLUMNS), value, dtype=np.float32))
    assert not np.isfinite(ranges).any()
    if isinf(value):
        assert np.mean(ranges == value) > 0.8


def test_an_image_with_too_few_rows():
    with pytest.raises(ValueError, match=r"scan_height \( 600 pixels\) is too large for the image height."):
        scan(np.zeros((ROWS, COLUMNS), dtype=np.uint16), 600)


def test_points_beside_the_loop():
    rng = np.random.default_rng(5)
    points = rng.normal(scale=2.0, size=(3000, 3)).astype(np.float32)
    points[rng.random(3000) < 0.1] = nan
    first, last, step = -2.0, 1.5, 0.0137
    ranges = ranges_of_points(points, (first, last, step), (-0.3, 0.8), (0.5, 4.0), inf)
    expected = [inf] * ceil((last - first) / step)
    for x, y, z in points.tolist():
        distance, angle = hypot(x, y), atan2(y, x)
        if isnan(x) or not (-0.3 <= z <= 0.8 and 0.5 <= distance <= 4.0 and first <= angle <= last):
            continue
        place = int((angle - first) / step)
        expected[place] = min(expected[place], distance)
    assert len(ranges) == len(expected)
    assert np.isclose(ranges, expected, rtol=1e-6).mean() > 0.98  # but for points on an edge
    assert np.isfinite(ranges).sum() == pytest.approx(np.isfinite(expected).sum(), abs=3)


def test_nothing_is_infinitely_far_or_beyond_the_range():
    ranges = ranges_of_points(np.array([[1.0, 0.0, 0.5]]), (-pi, pi, pi / 180), (0.0, 1.0), (0.0, 10.0), 11.0)
    assert len(ranges) == 360
    assert sorted(set(ranges.tolist())) == [1.0, 11.0]
    assert ranges[180] == 1.0
