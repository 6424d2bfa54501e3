"""A scalar field in pieces, each a sum of polynomials of x, y and z, as gz-math has it."""

from collections.abc import Sequence

import numpy as np

from drake_twin.description.plugins.wind import FieldPiece


class ScalarField:
    """A field of which the first piece that has a place counts; zero where none has it.

    Args:
        pieces: The pieces.

    Attributes:
        constant: Its value if that is the same everywhere; else None.
    """

    def __init__(self, pieces: Sequence[FieldPiece]):
        self._pieces = pieces
        first = pieces[0] if pieces else None
        self.constant = first.constant if first is not None and first.is_everywhere else None

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return its values at points (n×3, m)."""
        values, left = np.zeros(len(points)), np.ones(len(points), dtype=bool)
        for piece in self._pieces:
            here = left.copy()
            for interval, along in zip(piece.region, points.T, strict=True):
                above = along >= interval.low if interval.has_low else along > interval.low
                here &= above & (along <= interval.high if interval.has_high else along < interval.high)
            powers = [np.polyval(item, along) for item, along in zip(piece.polynomials, points.T, strict=True)]
            values[here] = piece.factor * np.sum(powers, axis=0)[here]
            left &= ~here
        return values
