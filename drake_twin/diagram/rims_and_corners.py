"""Points beside the faces of loose shapes: the rims that cylinders roll on, corners that bodies tip over, their feet.

As facets a cylinder's curved side would brake: it loses half of its speed in three seconds. So it has two rims, thin
ellipsoids that touch in points.

The force on a facet acts at its middle, so that a face cannot bear a body closer to its edge than by half a facet:
pushed at its top, a body of 10 by 30 cm would tip at 0.7 of the force that it should. So boxes and hulls have small
balls in their corners. They meet what does not move and is thick; of a thin or a moving body Drake may find the
wrong side for a ball that has sunk in.

On a plane the corners alone say all about where a convex body stands, at a third of the cost of faces. So it has feet,
which meet planes in place of its faces: a ball in each corner, and one in the middle of each side. With the corners
alone a body that spins on the ground would be braked 1.8 times as fast as by a pressure that is even over its side.
The middle bears so much that both are the same.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
from pydrake.geometry import Box, Convex, Cylinder, Ellipsoid, Shape, Sphere
from pydrake.math import RigidTransform

from drake_twin.dataclass import dataclass
from drake_twin.description.hull import corners_of, mean_distance, planes_of, sides_under
from drake_twin.diagram.contact_shapes import DISSIPATION, POINT_STIFFNESS, STIFFEST, UPRIGHT, ContactShape, Part
from drake_twin.diagram.round_hulls import RoundHull, round_hull

# The faceted cylinder stays inside its rims by this part of its radius, and no more than so much (m): more than rims
# sink in, less than is seen.
_RECESS = 0.01
_DEEPEST_RECESS = 5e-4

# Half of a rim's thickness, relative to the radius and to the length.
_THICK = 0.1
_SHARE = 0.05

_LEAST = 1e-4  # m

# The balls in the corners have a radius of this part of the smallest side: so much too early a body tips.
_BALL = 0.005

# How stiff a ball in a corner is at least (1/s²), and relative to `UPRIGHT` times the height ÷ width² of the slimmest
# face, so that its yielding lets the body tip by 0.25 % too early. With more, little is left for the face: on a slope
# of 0.95 of the friction angle, at a step of 10 ms, a box would creep by more than 0.2 mm in 5 s. Drake's solver
# regularizes the friction of a point the more, the more that point bears. So what is slim has two balls in each corner.
# Compact things have one, twice as stiff: a ball on the ground costs as much time as two facets.
CORNER_STIFFNESS = 2e4  # of each of two balls
_SLIM = 10.0

# Hunt and Crossley's dissipation of corners (s/m). They may be slow, since the face beside them comes out: what rocks
# from edge to edge stops. It grows with their stiffness, as they move by less, up to a limit. With four times the least
# a crate brakes the rover that pushes it; with six times the limit Drake's solver failed where a slim bar fell over.
_CORNER_DISSIPATION = 500.0
_MOST_DISSIPATION = 1e4

# How stiff a ball in a corner is at least that is a foot (1/s²). A box sinks by 22 µm under its own weight.
# Stiffer ones, of slim things, have the square of that more dissipation: a door of 2 m by 4 cm would rock for long.
_FOOT_STIFFNESS = 6e4

_FARTHEST = 10.0  # of the ball in a sharp corner from its tip, relative to the ball's radius
_MOST_LOOSE = 40  # shapes with corners; a plant takes time and memory with the square of its shapes' number
_MOST_CORNERS = 32  # of a hull; more belong to round things
_DIGITS = 12  # decimals of a place (m) and of a share: the last bits of what is solved differ between NumPy's versions


def recess_of(radius: float) -> float:
    """Return how far inside its rims the side of a loose cylinder of a radius (m) is (m)."""
    return min(_RECESS * radius, _DEEPEST_RECESS)


def with_points(shapes: Sequence[ContactShape], warnings: list[str]) -> list[ContactShape]:
    """Return shapes and the points beside their faces, which are not registered yet.

    Args:
        shapes: All shapes.
        warnings: Is extended if there are too many for corners.
    """
    loose = sum(shape.is_loose and shape.is_flat and not isinstance(shape.shape, Cylinder) for shape in shapes)
    if loose > _MOST_LOOSE:
        what = f"above {_MOST_LOOSE} they touch with their faces only, so that slim ones fall over too early"
        warnings.append(f"the world has {loose} loose boxes and meshes: {what}")
    met = {shape.part for shape in shapes}
    found = []
    for shape in shapes:
        if not (shape.is_loose and shape.is_flat):
            found.append(shape)
        elif isinstance(shape.shape, Cylinder):
            radius, length = shape.shape.radius(), shape.shape.length()
            thinner = Cylinder(radius - recess_of(radius), length)
            found += [replace(shape, shape=thinner), *_rims(shape, radius, length)]
        elif isinstance(shape.shape, Convex) and (hull := round_hull(shape.shape)) is not None:
            found += [replace(shape, shape=hull.within(recess_of(max(hull.radii)))), *_rims_of_hull(shape, hull)]
        elif loose > _MOST_LOOSE:
            found.append(shape)
        else:
            feet = list(_feet(shape)) if Part.PLANE in met else []
            found += [replace(shape, part=Part.FACES) if feet else shape, *feet]
            found += _corners(shape) if Part.THICK in met else ()
    return found


def _rims(shape: ContactShape, radius: float, length: float) -> Iterator[ContactShape]:
    half = min(_THICK * radius, _SHARE * length)
    rim = Ellipsoid(radius, radius, half)
    # From the middle; inside the end, which is flat.
    apart = max(length / 2 - half - recess_of(radius), 0.0)
    # Two points hold it upright if they are stiffer (1/s²) than g radius ÷ (2 apart²).
    stiffness = max(POINT_STIFFNESS, UPRIGHT * radius / (2 * max(apart, _LEAST) ** 2))
    for number, side in enumerate((-1, 1)):
        yield _point(shape, f"rim{number}", rim, (0.0, 0.0, side * apart), stiffness)


def _rims_of_hull(shape: ContactShape, hull: RoundHull) -> Iterator[ContactShape]:
    rims = hull.rims()
    apart = float(np.linalg.norm(rims[0][1].translation() - rims[1][1].translation())) / 2
    stiffness = max(2 * POINT_STIFFNESS, UPRIGHT * max(hull.radii) / (2 * max(apart, _LEAST) ** 2))
    for number, (rim, pose) in enumerate(rims):
        part = _point(shape, f"rim{number}", rim, (0.0, 0.0, 0.0), stiffness)
        yield replace(part, X_BG=shape.X_BG @ pose)


@dataclass(frozen=True)
class _Balls:
    """The balls that a box or a hull can have in its corners.

    Attributes:
        points: The corners (n×3, m).
        places: Of the balls in them (n×3, m).
        radius: Of the balls (m).
        slim: The stiffness of each of two that keeps a slim shape from tipping over too early (1/s²).
    """

    points: np.ndarray
    places: np.ndarray
    radius: float
    slim: float


def _balls(form: Shape) -> _Balls | None:
    """Return the balls of a box or a hull; None for round ones."""
    signs = np.array(list(product((-1.0, 1.0), repeat=3)))
    if isinstance(form, Box):
        points = 0.5 * signs * form.size()
    else:
        assert isinstance(form, Convex)
        points = corners_of(form.GetConvexHull())
    if len(points) > _MOST_CORNERS:
        return None
    smallest, _, largest = sorted(np.ptp(points, axis=0).tolist())
    radius = _BALL * smallest
    places = points - radius * signs if isinstance(form, Box) else _moved_inside(points, radius)
    return _Balls(points, places, radius, _SLIM * UPRIGHT * largest / max(smallest, _LEAST) ** 2)


def _corners(shape: ContactShape) -> Iterator[ContactShape]:
    balls = _balls(shape.shape)
    if balls is None:
        return
    count, stiffness = (2, balls.slim) if balls.slim > CORNER_STIFFNESS else (1, 2 * CORNER_STIFFNESS)
    for number, place in enumerate(np.repeat(balls.places, count, axis=0)):
        part = _point(shape, f"corner{number}", Sphere(balls.radius), place.tolist(), stiffness)
        dissipation = min(_CORNER_DISSIPATION * stiffness / CORNER_STIFFNESS, _MOST_DISSIPATION)
        yield replace(part, part=Part.CORNER, point_dissipation=dissipation)


def _feet(shape: ContactShape) -> Iterator[ContactShape]:
    balls = _balls(shape.shape)
    if balls is None:
        return
    stiffness = max(_FOOT_STIFFNESS, 2 * balls.slim)
    dissipation = min(DISSIPATION * (stiffness / _FOOT_STIFFNESS) ** 2, _MOST_DISSIPATION)
    feet = [(place, stiffness) for place in balls.places]
    middles = [(place, round(share, _DIGITS)) for place, share in _middles(shape, balls)]
    feet += [(place, share * stiffness) for place, share in middles if share]
    for number, (place, stiff) in enumerate(feet):
        part = _point(shape, f"foot{number}", Sphere(balls.radius), place.tolist(), stiff)
        yield replace(part, part=Part.FOOT, point_dissipation=dissipation)


def _middles(shape: ContactShape, balls: _Balls) -> Iterator[tuple[np.ndarray, float]]:
    """Yield the place of a ball in the middle of each side (m), and its stiffness relative to that of a corner."""
    if isinstance(shape.shape, Box):
        half = shape.shape.size() / 2
        for axis in range(3):
            across = np.delete(half, axis)
            corners = float(np.hypot(*across))
            even = mean_distance(np.array(list(product((-1, 1), repeat=2))) * across)
            share = 4 * (corners / even - 1) if even > 0 else 0.0  # else it is as thin as nothing
            for sign in (-1, 1):
                yield sign * (half[axis] - balls.radius) * np.eye(3)[axis], share
        return
    center = shape.X_BG.inverse() @ shape.body.default_com()
    for side in sides_under(balls.points, center):
        distances = np.linalg.norm(side.corners - side.middle, axis=1)
        place = np.round(side.middle - balls.radius * side.normal, _DIGITS)
        yield place, max(float((distances / side.mean_distance - 1).sum()), 0.0)


def _moved_inside(points: np.ndarray, distance: float) -> np.ndarray:
    """Return the corners of a hull (n×3, m), each moved away by a distance (m) from the sides that meet there."""
    normals, offsets = planes_of(points)
    moved = points.copy()
    for index, point in enumerate(points):
        own = normals[np.abs(normals @ point - offsets) < 1e-6 * float(np.ptp(points, axis=0).max())]
        move = np.linalg.lstsq(own, np.full(len(own), -distance), rcond=None)[0]
        moved[index] += move * min(1.0, _FARTHEST * distance / max(float(np.linalg.norm(move)), _LEAST * distance))
    return np.round(moved, _DIGITS)


def _point(
    shape: ContactShape, name: str, form: Ellipsoid | Sphere, place: Sequence[float], stiffness: float
) -> ContactShape:
    """Return a part of a shape that touches in a point, at a place in the shape's frame (m)."""
    pose = shape.X_BG @ RigidTransform(np.array(place))
    name = f"{shape.name}|{name}"
    part = replace(shape, geometry=None, name=name, shape=form, X_BG=pose, is_flat=False)
    return replace(part, point_stiffness=min(stiffness, STIFFEST))
