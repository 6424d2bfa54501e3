"""Laser scans of depth images and of clouds of points, for the programs that make them."""

from math import ceil, inf, nan

import numpy as np


def ranges_of_depths(
    depths: np.ndarray,
    unit: float,
    camera: tuple[float, float, float],
    rays: tuple[float, float],
    height: int,
    limits: tuple[float, float],
) -> tuple[float, float, np.ndarray]:
    """Return the ranges (m) that the middle rows of a depth image show, the nearest of each column's.

    Source: ros-perception/depthimage_to_laserscan (ros2), DepthImageToLaserScan.hpp.

    Args:
        depths: The image: ``uint16`` with zero for nothing, or ``float32``, shape (rows, columns).
        unit: What a value of one is (m).
        camera: Its focal length and its principal point (pixels): fx, cx, cy.
        rays: Where the left and the right edge are, x/z.
        height: The number of rows.
        limits: The least and the greatest range (m) that count.

    Returns:
        The first angle (rad, to the right) and the last one, and a range for each column, from right to left.

    Raises:
        ValueError: If the image has too few rows.
    """
    fx, cx, cy = camera
    rows, columns = depths.shape
    if height // 2 > cy or height // 2 > rows - cy:
        raise ValueError(f"scan_height ( {height} pixels) is too large for the image height.")
    first, last = np.float32(-np.arctan(rays[1])), np.float32(np.arctan(-rays[0]))
    step = np.float32((last - first) / (columns - 1))
    start = int(cy - height / 2.0)
    depth = depths[start : start + height].astype(float)
    across = (np.arange(columns) - np.float32(cx)) / fx
    places = np.clip(((-np.arctan(across) - first) / step).astype(int), 0, columns - 1)
    is_valid = np.isfinite(depth) if depths.dtype.kind == "f" else depth > 0
    ranges = np.where(is_valid, depth * unit * np.hypot(across, 1.0), depth)
    places = np.broadcast_to(places, ranges.shape)
    found = np.full(columns, nan)
    is_infinite = np.isinf(ranges)
    found[places[is_infinite]] = ranges[is_infinite]
    nearest = np.full(columns, inf)
    counts = is_valid & (ranges >= limits[0]) & (ranges <= limits[1])
    np.minimum.at(nearest, places[counts], ranges[counts])
    return float(first), float(last), np.where(np.isfinite(nearest), nearest, found)


def ranges_of_points(
    points: np.ndarray,
    angles: tuple[float, float, float],
    heights: tuple[float, float],
    limits: tuple[float, float],
    empty: float,
) -> np.ndarray:
    """Return the ranges (m) at which points stand, the nearest in each angle.

    Source: ros-perception/pointcloud_to_laserscan, src/pointcloud_to_laserscan_node.cpp.

    Args:
        points: x, y and z (m), shape (n, 3).
        angles: The first and the last angle, and the step (rad).
        heights: The least and the greatest z that counts.
        limits: The least and the greatest range that counts.
        empty: The range where nothing is.
    """
    first, last, step = (np.float32(angle) for angle in angles)
    size = ceil((last - first) / step)
    points = points.astype(float)
    x, y, z = points.T
    ranges, directions = np.hypot(x, y), np.arctan2(y, x)
    counts = (z >= heights[0]) & (z <= heights[1]) & (ranges >= limits[0]) & (ranges <= limits[1])
    counts &= (directions >= first) & (directions <= last)  # a NaN compares as false
    places = ((directions[counts] - first) / step).astype(int)
    found = np.full(size, empty)
    is_inside = places < size
    np.minimum.at(found, places[is_inside], ranges[counts][is_inside])
    return found
