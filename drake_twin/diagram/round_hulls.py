"""Hulls that are round about an axis: cones, cups, buckets, bottles.

Such a body rolls on the longest straight part of its outline, a cone about its apex. As facets that side would brake
it, as those of a cylinder do (see ``rims_and_corners``).
"""

from math import hypot, sqrt

import numpy as np
from pydrake.geometry import Convex, Ellipsoid
from pydrake.math import RigidTransform, RotationMatrix

from drake_twin.dataclass import dataclass
from drake_twin.description.hull import corners_of

_ROUND = 2e-3  # relative to the hull's size: how far its corners are from circles about an axis
_LEAST_SIDES = 16  # of each circle
_MOST_CIRCLES = 64
_LEAST_SIDE = 0.5  # of the side that rolls, relative to the whole outline between the ends
_STEEPEST = 0.2  # the cosine of the side's angle from the axis; what is flatter is a plate

_THIN = 0.1  # half of a rim's thickness, relative to its radius
_SHARE = 0.05  # and relative to the side's length
_TIP = 0.15  # radius of a ball near the tip, relative to the largest one
_SIDES = 24  # of the hull within: with more its faces have no core, and cost more


@dataclass(frozen=True)
class RoundHull:
    """A hull that is round about an axis.

    Attributes:
        X_GA: The frame of the axis (z) in the hull's.
        radii: Of the circles around it, in their order along the axis (m).
        places: Of these circles along the axis (m).
        side: The number of the circle at which the side begins that it rolls on.
    """

    X_GA: RigidTransform
    radii: tuple[float, ...]
    places: tuple[float, ...]
    side: int

    def rims(self) -> list[tuple[Ellipsoid, RigidTransform]]:
        """Return two ellipsoids inside that touch the side from within, and their poses in the hull's frame."""
        (r0, r1), (z0, z1) = self.radii[self.side : self.side + 2], self.places[self.side : self.side + 2]
        length = hypot(r1 - r0, z1 - z0)
        along_r, along_z = (r1 - r0) / length, (z1 - z0) / length
        normal_r, normal_z = along_z, -along_r
        found = []
        for end, towards in (((r0, z0), 1.0), ((r1, z1), -1.0)):
            least = _TIP * max(r0, r1)
            if end[0] < least and abs(along_r) > 1e-9:  # a ball that is as far from the tip
                radius, place = least, end[1] + towards * along_z * (least - end[0]) / abs(along_r)
                ball = radius / normal_r
                place -= ball * normal_z
                rim = Ellipsoid(ball, ball, ball)
            else:
                half = min(_THIN * end[0], _SHARE * length)
                inwards = half * (1 + abs(normal_z)) / along_z  # along the side
                radius, place = end[0] + towards * along_r * inwards, end[1] + towards * along_z * inwards
                # Its outline has the side's direction at this radius.
                square = radius**2 * (1 + sqrt(1 + (2 * half * normal_z / (radius * normal_r)) ** 2)) / 2
                place -= half**2 * normal_z / sqrt(square * normal_r**2 + half**2 * normal_z**2)
                rim = Ellipsoid(sqrt(square), sqrt(square), half)
            found.append((rim, self.X_GA @ RigidTransform([0.0, 0.0, place])))
        return found

    def within(self, recess: float) -> Convex:
        """Return the hull whose side is so much (m) farther inside, with fewer corners."""
        (r0, r1), (z0, z1) = self.radii[self.side : self.side + 2], self.places[self.side : self.side + 2]
        slope = (r1 - r0) / (z1 - z0)
        first = r0 - recess * hypot(1.0, slope)  # of the side farther inside, at its first circle
        points = []
        angles = 2 * np.pi * np.arange(_SIDES) / _SIDES
        for radius, place in zip(self.radii, self.places, strict=True):
            inside = min(radius, first + slope * (place - z0))
            if inside <= 0.0:  # beyond the tip of what is inside
                points.append((0.0, 0.0, z0 - first / slope))
            else:
                points += [(inside * np.cos(angle), inside * np.sin(angle), place) for angle in angles]
        corners = (self.X_GA @ np.array(points).T).T
        return Convex(np.ascontiguousarray(np.round(corners, 12).T), "round")


def round_hull(shape: Convex) -> RoundHull | None:
    """Return a hull as a body that is round about an axis of its frame; None for others, and for balls."""
    corners = corners_of(shape.GetConvexHull())
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    near = _ROUND * float((upper - lower).max())
    for axis in range(3):
        one, other = (axis + 1) % 3, (axis + 2) % 3
        if abs((upper - lower)[one] - (upper - lower)[other]) > 10 * near:
            continue
        center = (lower + upper) / 2
        center[axis] = 0.0
        around = corners - center
        circles = _circles(around[:, axis], np.hypot(around[:, one], around[:, other]), near)
        if circles is None:
            continue
        radii, places = circles
        lengths = [hypot(*step) for step in zip(np.diff(radii), np.diff(places), strict=True)]
        side = int(np.argmax(lengths))
        steep = (places[side + 1] - places[side]) / lengths[side]
        if max(radii) > near and lengths[side] >= _LEAST_SIDE * sum(lengths) and steep >= _STEEPEST:
            X_GA = RigidTransform(RotationMatrix.MakeFromOneVector(np.eye(3)[axis], 2), center)
            return RoundHull(X_GA, tuple(radii), tuple(places), side)
    return None


def _circles(places: np.ndarray, radii: np.ndarray, near: float) -> tuple[list[float], list[float]] | None:
    """Return the radii and places of the circles on which points are (m); None if they are not on circles."""
    order = np.argsort(places, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(places[order]) > near) + 1)
    if not 2 <= len(groups) <= _MOST_CIRCLES:
        return None
    found: tuple[list[float], list[float]] = ([], [])
    for group in groups:
        radius = float(radii[group].max())
        if radius < near:
            radius = 0.0
        elif np.ptp(radii[group]) > near or len(group) < _LEAST_SIDES:
            return None
        found[0].append(radius)
        found[1].append(float(places[group].mean()))
    return found
