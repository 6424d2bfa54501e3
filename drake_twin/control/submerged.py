"""How much of a solid is below a level surface, and the center of that part.

Ellipsoids have closed forms, and so have the discs of cylinders. Other solids are closed surfaces of triangles, convex
or not: each triangle is cut at the surface, and makes a tetrahedron with a point of the surface as its tip, so that the
lid that closes the part below has no volume of its own.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from drake_twin.control.submerged_cylinders import SubmergedCylinders
from drake_twin.dataclass import dataclass

_SIDES = 48
_NO_TRIANGLES = np.zeros((0, 3, 3))


@dataclass(frozen=True)
class Solid:
    """A solid on a body B.

    Attributes:
        volume: Its volume (m³).
        center: The center of that (m), in B's frame.
        axes: The half axes of an ellipsoid as columns (3×3, m), in B's frame; None for a surface of triangles.
        triangles: The corners of each triangle (n×3×3, m), counterclockwise as seen from outside; none of an ellipsoid.
        radius: That of a cylinder (m), which has no triangles either.
        half_axis: From its middle to the middle of one end (m), in B's frame; None for any other solid.
    """

    volume: float
    center: np.ndarray
    axes: np.ndarray | None
    triangles: np.ndarray
    radius: float = 0.0
    half_axis: np.ndarray | None = None


def ellipsoid(half_axes: Sequence[float], R: np.ndarray, center: np.ndarray) -> Solid:
    """Return an ellipsoid, or a sphere, whose axes are the columns of a rotation matrix."""
    volume = 4.0 / 3.0 * np.pi * float(np.prod(half_axes))
    return Solid(volume, np.asarray(center, dtype=float), R * np.asarray(half_axes, dtype=float), _NO_TRIANGLES)


def cylinder(radius: float, length: float, R: np.ndarray, center: np.ndarray) -> Solid | None:
    """Return a cylinder along the last column of a rotation matrix; None if it has no volume."""
    if not min(radius, length) > 0.0:
        return None
    volume = np.pi * radius**2 * length
    return Solid(volume, np.asarray(center, dtype=float), None, _NO_TRIANGLES, radius, R[:, 2] * length / 2)


def surface(triangles: np.ndarray) -> Solid | None:
    """Return the solid in a closed surface of triangles (n×3×3, m); None if it has no volume."""
    triangles = np.asarray(triangles, dtype=float)
    if not len(triangles):
        return None
    middle = triangles.mean(axis=(0, 1))
    volumes = np.linalg.det(triangles - middle) / 6.0
    volume = float(volumes.sum())
    size = float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    if not abs(volume) > 1e-9 * size**3:
        return None
    center = middle + (volumes / volume) @ (triangles - middle).sum(axis=1) / 4.0
    return Solid(abs(volume), center, None, triangles if volume > 0 else triangles[:, ::-1])


def is_closed(vertices: np.ndarray, faces: np.ndarray) -> bool:
    """Tell whether each edge of the triangles has exactly one partner in the other direction."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    keys, reverse = edges @ [len(vertices), 1], edges[:, ::-1] @ [len(vertices), 1]
    return len(np.unique(keys)) == len(keys) and bool(np.array_equal(np.sort(keys), np.sort(reverse)))


def box_triangles(size: Sequence[float]) -> np.ndarray:
    """Return the triangles of a box about the origin, from its edges (m)."""
    x, y = size[0] / 2, size[1] / 2
    return _prism(np.array([[x, y], [-x, y], [-x, -y], [x, -y]]), size[2])


def capsule_triangles(radius: float, length: float) -> np.ndarray:
    """Return the triangles of a capsule along z, from the length of its cylinder, as a surface of its volume."""
    rings = _SIDES // 4
    angles = np.linspace(-np.pi / 2, np.pi / 2, 2 * rings)[1:-1]
    circle = _circle(1.0)
    levels = [np.column_stack([np.cos(a) * circle, np.full(len(circle), np.sin(a))]) for a in angles]
    points = radius * np.array(levels)
    points[: len(angles) // 2, :, 2] -= length / 2
    points[len(angles) // 2 :, :, 2] += length / 2
    top, bottom = np.array([0, 0, length / 2 + radius]), np.array([0, 0, -length / 2 - radius])
    triangles = []
    for low, high in pairwise(points):
        triangles += _band(low, high)
    triangles += [[bottom, b, a] for a, b in zip(points[0], np.roll(points[0], -1, axis=0), strict=True)]
    triangles += [[top, a, b] for a, b in zip(points[-1], np.roll(points[-1], -1, axis=0), strict=True)]
    found = np.array(triangles)
    exact = np.pi * radius**2 * (length + 4.0 / 3.0 * radius)
    solid = surface(found)
    if solid is not None:
        found[..., :2] *= np.sqrt(exact / solid.volume)
    return found


def _circle(radius: float) -> np.ndarray:
    """Return the corners of a polygon with the area of a circle, counterclockwise."""
    angles = np.linspace(0.0, 2.0 * np.pi, _SIDES, endpoint=False)
    radius *= np.sqrt(2.0 * np.pi / (_SIDES * np.sin(2.0 * np.pi / _SIDES)))
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def _prism(corners: np.ndarray, height: float) -> np.ndarray:
    low = np.column_stack([corners, np.full(len(corners), -height / 2)])
    high = low + np.array([0.0, 0.0, height])
    triangles = _band(low, high)
    triangles += [[high[0], a, b] for a, b in pairwise(high[1:])]
    triangles += [[low[0], b, a] for a, b in pairwise(low[1:])]
    return np.array(triangles)


def _band(low: np.ndarray, high: np.ndarray) -> list[list[np.ndarray]]:
    """Return the triangles between two polygons, counterclockwise from above, as seen from outside."""
    after, above = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
    corners = list(zip(low, after, high, above, strict=True))
    return [[a, b, d] for a, b, _, d in corners] + [[a, d, c] for a, _, c, d in corners]


class SubmergedSolids:
    """Compute how much of each of many solids is below a level surface.

    What is wholly on one side of it costs next to nothing; only solids that it crosses are cut.

    Args:
        solids: The solids, each in the frame of its body.
    """

    def __init__(self, solids: Sequence[Solid]):
        self.volumes = np.array([solid.volume for solid in solids])
        self.centers = np.array([solid.center for solid in solids]).reshape(-1, 3)
        axes = [solid.axes for solid in solids if solid.axes is not None]
        self._axes = np.array(axes).reshape(-1, 3, 3)
        self._has_triangles = np.array([len(solid.triangles) > 0 for solid in solids], dtype=bool)
        self._round = np.flatnonzero([solid.axes is not None for solid in solids])
        halves = {place: solid.half_axis for place, solid in enumerate(solids) if solid.half_axis is not None}
        self._along = np.array(list(halves), dtype=int)
        half_axes = np.array(list(halves.values())).reshape(-1, 3)
        lengths = np.linalg.norm(half_axes, axis=1)
        radii = np.array([solids[place].radius for place in halves])
        self._cylinders = SubmergedCylinders(half_axes / lengths[:, None], lengths, radii)
        self._reaches = np.hypot(lengths, radii)
        self._triangles = np.concatenate([_NO_TRIANGLES, *(solid.triangles for solid in solids)])
        self._owners = np.repeat(np.arange(len(solids)), [len(solid.triangles) for solid in solids])
        self._radii = np.array(
            [
                np.linalg.norm(solid.triangles - solid.center, axis=2).max() if len(solid.triangles) else 0.0
                for solid in solids
            ]
        )

    def below(self, up: np.ndarray, heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the volumes below a surface (n, m³), and volume times center (n×3, m⁴), in the bodies' frames.

        Args:
            up: The direction away from the surface in each body's frame (n×3).
            heights: The height of the origin of that frame above the surface (n, m).
        """
        over = np.einsum("ni,ni->n", up, self.centers) + heights  # the height of the solid's center
        volumes = np.where(over < 0.0, self.volumes, 0.0)
        moments = volumes[:, None] * self.centers
        if len(self._round):
            round_ones = self._round
            along = np.einsum("nij,ni->nj", self._axes, up[round_ones])
            half = np.sqrt(np.einsum("ni,ni->n", along, along))
            t = np.clip(-over[round_ones] / half, -1.0, 1.0)
            # Of a unit sphere: the part of its volume below t, and that part's moment along the axis.
            whole = self.volumes[round_ones]
            volumes[round_ones] = own = whole * (2.0 + 3.0 * t - t**3) / 4.0
            shift = -3.0 / 16.0 * (1.0 - t * t) ** 2 * whole / half
            moments[round_ones] = own[:, None] * self.centers[round_ones] + np.einsum(
                "nij,nj->ni", self._axes, shift[:, None] * along
            )
        chosen = np.flatnonzero(np.abs(over[self._along]) < self._reaches)
        if len(chosen):
            places = self._along[chosen]
            volumes[places], about = self._cylinders.below(chosen, up[places], over[places])
            moments[places] = volumes[places, None] * self.centers[places] + about
        crossed = self._has_triangles & (np.abs(over) < self._radii)
        if crossed.any():
            volumes[crossed], moments[crossed] = self._cut(crossed, up, over)
        return volumes, moments

    def _cut(self, crossed: np.ndarray, up: np.ndarray, over: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the same of the solids whose triangles a surface may cross."""
        chosen = crossed[self._owners]
        owners = self._owners[chosen]
        # Relative to the point of the surface that is nearest to the solid's center.
        tips = self.centers - over[:, None] * up
        corners = self._triangles[chosen] - tips[owners][:, None, :]
        depths = np.einsum("nki,ni->nk", corners, up[owners])
        is_below = depths < 0.0
        count = is_below.sum(axis=1)
        whole = np.where(count >= 2, np.linalg.det(corners), 0.0) / 6.0
        found = np.empty((len(owners), 4))
        found[:, 0], found[:, 1:] = whole, whole[:, None] * corners.sum(axis=1) / 4.0
        cut = np.flatnonzero((count == 1) | (count == 2))
        if len(cut):
            # The corner that is alone on its side comes first; its two edges are cut.
            is_alone = is_below[cut] == (count[cut] == 1)[:, None]
            first = np.argmax(is_alone, axis=1)
            order = (first[:, None] + np.arange(3)) % 3
            part, depth = corners[cut[:, None], order], depths[cut[:, None], order]
            share = depth[:, :1] / (depth[:, :1] - depth[:, 1:])
            part[:, 1:] = part[:, :1] + share[:, :, None] * (part[:, 1:] - part[:, :1])
            small = np.where(count[cut] == 1, 1.0, -1.0) * np.linalg.det(part) / 6.0
            found[cut, 0] += small
            found[cut, 1:] += small[:, None] * part.sum(axis=1) / 4.0
        starts = np.flatnonzero(np.diff(owners, prepend=-1))
        sums = np.add.reduceat(found, starts)
        return sums[:, 0], sums[:, 1:] + sums[:, :1] * tips[crossed]
