"""The points that a message of rays holds, and what they can be colored by."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from drake_twin.cockpit.color_map import Legend

RANGE, HEIGHT, INTENSITY, PLAIN = "range", "height", "intensity", "one color"
UNITS = {RANGE: "m", HEIGHT: "m", INTENSITY: ""}
_MOST_POINTS = 19_997  # of a cloud: a prime, so that those of a picture that are drawn do not lie in a few columns


class Measured(NamedTuple):
    """What rays have met.

    Attributes:
        points: The points in the sensor's frame (m), shape (n, 3).
        intensities: Their intensities; None if the message has none.
    """

    points: np.ndarray
    intensities: np.ndarray | None

    def values(self, by: str, X_points: np.ndarray) -> np.ndarray | None:
        """Return what points are colored by, shape (n,).

        Args:
            by: ``range``, ``height`` or ``intensity``.
            X_points: The points in the world (m), shape (n, 3).

        Returns:
            None if they are of one color, or the message has no such values.
        """
        if by == RANGE:
            return np.asarray(np.linalg.norm(self.points, axis=1))
        if by == HEIGHT:
            return np.asarray(X_points[:, 2])
        return self.intensities if by == INTENSITY else None

    def colors(self, by: str, X_points: np.ndarray) -> tuple[np.ndarray | None, Legend | None]:
        """Return the points' colors, shape (n, 3), and their legend; None if they are of one color."""
        values = self.values(by, X_points)
        legend = None if values is None else Legend.of(values, by, UNITS[by])
        return (None, None) if values is None or legend is None else (legend.colors(values), legend)

    @property
    def choices(self) -> tuple[str, ...]:
        """What they can be colored by."""
        return (RANGE, HEIGHT, *((INTENSITY,) if self.intensities is not None else ()), PLAIN)


def measured(message: Any) -> Measured:
    """Return what a message of rays has met: what met nothing is left out, and a large cloud is evenly thinned out."""
    intensities: np.ndarray | None = None
    if hasattr(message, "ranges"):
        ranges = np.asarray(message.ranges, dtype=float)
        angles = message.angle_min + message.angle_increment * np.arange(len(ranges))
        points = np.column_stack([ranges * np.cos(angles), ranges * np.sin(angles), np.zeros(len(ranges))])
        if len(message.intensities) == len(ranges) > 0:
            intensities = np.asarray(message.intensities, dtype=float)
    elif hasattr(message, "field_of_view"):
        angles = np.linspace(-0.5, 0.5, 15 if np.isfinite(message.range) else 0) * message.field_of_view
        points = message.range * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
    elif hasattr(message, "point_step"):
        offsets = {item.name: item.offset for item in message.fields if item.datatype == 7}  # FLOAT32
        names = [name for name in ("x", "y", "z", INTENSITY) if name in offsets]
        layout: Mapping[str, Any] = {
            "names": names,
            "formats": ["<f4"] * len(names),
            "offsets": [offsets[name] for name in names],
            "itemsize": message.point_step,
        }
        kind: Any = np.dtype(layout)  # type: ignore[call-overload]
        data: Any = _some(np.frombuffer(np.ascontiguousarray(message.data, dtype=np.uint8), kind))
        points = np.column_stack([data[axis] for axis in "xyz"]).astype(float)
        intensities = data[INTENSITY].astype(float) if INTENSITY in names else None
    else:
        points = np.array([(point.x, point.y, point.z) for point in _some(message.points)], dtype=float).reshape(-1, 3)
    met = np.isfinite(points).all(axis=1)
    return Measured(points[met], None if intensities is None else intensities[met])


def _some(items: Any) -> Any:
    """Return not more items than are drawn, evenly chosen."""
    count = len(items)
    if count <= _MOST_POINTS:
        return items
    chosen = np.arange(_MOST_POINTS) * count // _MOST_POINTS
    return items[chosen] if isinstance(items, np.ndarray) else [items[index] for index in chosen]
