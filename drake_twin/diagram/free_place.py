"""A place for another robot: beside what is there, not in it."""

from collections.abc import Iterator, Sequence
from math import ceil, cos, sin

import numpy as np
from pydrake.geometry import HalfSpace, QueryObject, Role
from pydrake.math import RotationMatrix

from drake_twin.dataclass import dataclass
from drake_twin.diagram.contact_shapes import reach_of
from drake_twin.diagram.footprint import Footprint

_APART = 0.3  # m between two robots
_FLAT = 0.02  # m: what reaches no higher is a floor
_WIDE = 50.0  # m: what is wider is a floor, too, or a wall far away
_DIRECTIONS = np.vstack([np.eye(3), -np.eye(3)])
_RINGS = 60  # of places that are tried


@dataclass(frozen=True)
class Area:
    """What something takes of the ground: a rectangle along the world's axes (m)."""

    lower: tuple[float, float]
    upper: tuple[float, float]

    def is_near(self, other: "Area", apart: float) -> bool:
        """Return whether another area is nearer than a distance (m) along both axes."""
        return all(self.lower[axis] - apart < other.upper[axis] for axis in (0, 1)) and all(
            other.lower[axis] - apart < self.upper[axis] for axis in (0, 1)
        )

    def moved(self, x: float, y: float) -> "Area":
        """Return it elsewhere."""
        return Area((self.lower[0] + x, self.lower[1] + y), (self.upper[0] + x, self.upper[1] + y))

    def has(self, x: float, y: float) -> bool:
        """Return whether a point is in it."""
        return self.lower[0] <= x <= self.upper[0] and self.lower[1] <= y <= self.upper[1]


def area_of(footprint: Footprint, yaw: float = 0.0) -> Area:
    """Return what a robot takes of the ground around its root link.

    Args:
        footprint: The robot's.
        yaw: How it is turned (rad).
    """
    corners = [
        (x * cos(yaw) - y * sin(yaw), x * sin(yaw) + y * cos(yaw))
        for x in (footprint.lower[0], footprint.upper[0])
        for y in (footprint.lower[1], footprint.upper[1])
    ]
    (left, right), (near, far) = ((min(values), max(values)) for values in zip(*corners, strict=True))
    return Area((left, near), (right, far))


def taken_areas(query: QueryObject, places: Sequence[tuple[float, float]]) -> list[Area]:
    """Return what is taken of the ground by all that things may collide with.

    Args:
        query: The scene graph's, at the present time.
        places: Where the robots are (m): a building in which one stands is hollow, whatever its bounding box.
    """
    inspector = query.inspector()
    found = []
    for geometry in inspector.GetAllGeometryIds(Role.kProximity):
        shape = inspector.GetShape(geometry)
        if isinstance(shape, HalfSpace) or inspector.IsDeformableGeometry(geometry):
            continue
        pose = query.GetPoseInWorld(geometry)
        directions = _DIRECTIONS @ RotationMatrix(pose.rotation()).matrix()
        reach = _DIRECTIONS @ pose.translation() + [reach_of(shape, direction) for direction in directions]
        upper, lower = reach[:3].tolist(), (-reach[3:]).tolist()
        area = Area((lower[0], lower[1]), (upper[0], upper[1]))
        is_floor = upper[2] <= _FLAT or max(upper[0] - lower[0], upper[1] - lower[1]) > _WIDE
        is_fixed = inspector.GetFrameId(geometry) == inspector.world_frame_id()
        if not is_floor and not (is_fixed and any(area.has(*place) for place in places)):
            found.append(area)
    return found


def free_place(area: Area, taken: Sequence[Area], near: tuple[float, float]) -> tuple[float, float]:
    """Return the place nearest to another one at which a robot is clear of all that is there: x and y of its root (m).

    Args:
        area: What the robot takes around its root link.
        taken: What is taken.
        near: The other place (m).
    """
    step = max(0.1, ceil(10 * max(np.subtract(area.upper, area.lower)) / 2) / 10)
    for x, y in _around():
        place = round(near[0] + step * x, 3) + 0.0, round(near[1] + step * y, 3) + 0.0
        if not any(area.moved(*place).is_near(other, _APART) for other in taken):
            return place
    return near


def _around() -> Iterator[tuple[int, int]]:
    """Yield the points of a grid from its middle outwards; to the left first, where the demos' robots stand."""
    points = [(x, y) for x in range(-_RINGS, _RINGS + 1) for y in range(-_RINGS, _RINGS + 1)]
    yield from sorted(points, key=lambda point: (point[0] ** 2 + point[1] ** 2, -point[1], point[0]))
