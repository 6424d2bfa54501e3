"""How much of a cylinder is below a level surface, and the moment of that part."""

import numpy as np

# Gauss's points on 0 … π: with z = -cos φ, what is integrated is smooth where a disc begins and ceases to be cut.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_COSINES = -np.cos(np.pi / 2 * (_NODES + 1.0))
_SHARES = np.pi / 2 * _WEIGHTS * np.sin(np.pi / 2 * (_NODES + 1.0)) / 2.0
_SMALL = 1e-12


class SubmergedCylinders:
    """Compute how much of each of many cylinders is below a level surface.

    A cylinder is made of discs, of which each is wholly below the surface, wholly above, or cut along a chord, where
    area and moment of the segment have closed forms. Those that are cut are summed up along the axis to 1e-9.

    Args:
        axes: The direction of each axis in the body's frame (n×3).
        half_lengths: Half the lengths (n, m).
        radii: The radii (n, m).
    """

    def __init__(self, axes: np.ndarray, half_lengths: np.ndarray, radii: np.ndarray):
        self._axes, self._halves, self._radii = axes, half_lengths, radii

    def below(self, chosen: np.ndarray, up: np.ndarray, over: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the volumes below a surface (k, m³), and their moments about the cylinders' middles (k×3, m⁴).

        Args:
            chosen: The indices of the cylinders that are meant.
            up: The direction away from the surface in the body's frame of each of these (k×3).
            over: The height of the middle of each of these above the surface (k, m).
        """
        axes, half, radius = self._axes[chosen], self._halves[chosen], self._radii[chosen]
        rise = np.einsum("ni,ni->n", axes, up)
        across = up - rise[:, None] * axes
        slant = np.maximum(np.sqrt(np.einsum("ni,ni->n", across, across)), _SMALL)
        rise = np.where(np.abs(rise) < _SMALL, _SMALL, rise)
        # Along the axis, discs are wholly below on one side of here, and wholly above on the other side of there.
        here, there = -(over + slant * radius) / rise, -(over - slant * radius) / rise
        here, there = np.clip(here, -half, half), np.clip(there, -half, half)
        whole = np.pi * radius**2 * np.where(rise > 0.0, here + half, half - here)
        end = np.where(rise > 0.0, -half, half)
        length = np.abs(there - here)
        z = ((here + there) / 2)[:, None] + (length / 2)[:, None] * _COSINES
        # The surface cuts the disc at z along x = chord · radius; x is the direction in which it rises most.
        chord = np.clip(-(over[:, None] + rise[:, None] * z) / (slant * radius)[:, None], -1.0, 1.0)
        root = np.sqrt(1.0 - chord * chord)
        shares = (radius**2 * length)[:, None] * _SHARES
        areas = shares * (np.arccos(-chord) + chord * root)
        volumes = whole + areas.sum(axis=1)
        along = whole * (here + end) / 2.0 + np.einsum("nk,nk->n", areas, z)
        outward = -2.0 / 3.0 * radius * np.einsum("nk,nk->n", shares, root**3)
        return volumes, along[:, None] * axes + (outward / slant)[:, None] * across
