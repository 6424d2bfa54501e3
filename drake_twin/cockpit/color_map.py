"""The colors of measured values, from dark blue for the lowest to yellow for the highest, and their legends."""

from typing import Any

import numpy as np

from drake_twin.dataclass import dataclass

_STOPS = np.array([[0.13, 0.18, 0.60], [0.12, 0.42, 0.82], [0.10, 0.70, 0.45], [0.95, 0.60, 0.12], [0.99, 0.88, 0.35]])


@dataclass(frozen=True)
class Legend:
    """What the colors of a picture or of points stand for.

    Attributes:
        quantity: What is colored, such as ``depth``.
        unit: Its unit.
        lower: The value of the first color.
        upper: The value of the last color.
        is_reversed: Whether the lowest value is yellow.
    """

    quantity: str
    unit: str
    lower: float
    upper: float
    is_reversed: bool = False

    @classmethod
    def of(cls, values: np.ndarray, quantity: str, unit: str, *, is_reversed: bool = False) -> "Legend | None":
        """Return the legend of values that reach over the whole map; None if none of them is finite."""
        known = values[np.isfinite(values)]
        return cls(quantity, unit, float(known.min()), float(known.max()), is_reversed) if known.size else None

    def colors(self, values: np.ndarray) -> np.ndarray:
        """Return the color of each value, shape (…, 3), from 0 to 1; values beyond the ends have the ends' colors."""
        share = (np.clip(values, self.lower, self.upper) - self.lower) / max(self.upper - self.lower, 1e-9)
        share = np.nan_to_num(1.0 - share if self.is_reversed else share)
        places = np.linspace(0.0, 1.0, len(_STOPS))
        return np.stack([np.interp(share, places, _STOPS[:, channel]) for channel in range(3)], axis=-1)

    def as_plain(self) -> dict[str, Any]:
        """Return it as plain data: ``stops`` are the colors from the lower to the upper end, from 0 to 255."""
        stops = np.round(255 * (_STOPS[::-1] if self.is_reversed else _STOPS)).astype(int).tolist()
        ends = {"lower": self.lower, "upper": self.upper}
        return {"quantity": self.quantity, "unit": self.unit, **ends, "stops": stops}
