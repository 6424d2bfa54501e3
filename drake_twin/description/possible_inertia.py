"""The inertia nearest to a given one that a body can have."""

from itertools import combinations

import numpy as np

_DENSITY_LEVER = 0.4  # of a solid sphere: I = 0.4 m r²
_LEAST_RADIUS = 0.01  # m: of the sphere in place of a missing inertia
_PHYSICAL_MARGIN = 1e-9  # relative
_LEAST_MOMENT = 1e-6  # relative to the largest: Drake cannot turn a body without one

# Where the moments of SDF and URDF stand in the tensor.
MOMENTS = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}

LEAST_MASS = 1e-3  # kg: of a link that moves and carries nothing


def small_sphere(mass: float) -> np.ndarray:
    """Return the inertia (kg·m², 3×3) of a small solid sphere of a mass (kg)."""
    return _DENSITY_LEVER * mass * _LEAST_RADIUS**2 * np.eye(3)


def possible_inertia(mass: float, tensor: np.ndarray) -> tuple[np.ndarray, str | None]:
    """Find the inertia nearest to a given one that a body can have.

    Args:
        mass: The body's mass (kg).
        tensor: The given inertia (kg·m², 3×3).

    Returns:
        The inertia, and why it differs from the given one; None where it does not.
    """
    if not np.any(tensor):
        return small_sphere(mass), f"it has mass but no inertia: that of a sphere of {_LEAST_RADIUS:g} m is used"
    moments, axes = np.linalg.eigh(tensor)
    repaired = _physical(moments)
    if np.abs(repaired - moments).max() <= _PHYSICAL_MARGIN * float(np.abs(moments).max()):
        return tensor, None
    changes = ", ".join(_change(*pair) for pair in zip(moments, repaired, strict=True))
    given = ", ".join(f"{moment:.3g}" for moment in moments)
    nearest = np.asarray(axes @ np.diag(repaired) @ axes.T)
    return nearest, f"no body has the principal moments {given} kg·m²: the nearest possible are used: {changes}"


def _change(moment: float, repaired: float) -> str:
    """Describe the change of a principal moment (kg·m²)."""
    has_share = moment > 1e-3 * repaired  # a change of more is not worth a percentage
    return f"{repaired:.3g} ({100 * (repaired / moment - 1):+.3g} %)" if has_share else f"{repaired:.3g}"


def _physical(moments: np.ndarray) -> np.ndarray:
    """Return the principal moments nearest to given ones that a body can have.

    No moment is larger than the other two together: they are those of three rods, one along each axis, whose moments
    are not negative. The nearest are on the face of that cone with the least difference.
    """
    largest = float(np.abs(moments).max())
    if moments.min() >= _LEAST_MOMENT * largest and 2 * moments.max() <= moments.sum() + _PHYSICAL_MARGIN * largest:
        return moments
    nearest = np.zeros(3)
    for count in (1, 2, 3):
        for rods in combinations(1.0 - np.eye(3), count):
            parts = np.linalg.lstsq(np.transpose(rods), moments, rcond=None)[0]
            found = parts @ rods
            if parts.min() >= 0 and np.linalg.norm(found - moments) < np.linalg.norm(nearest - moments):
                nearest = found
    parts = np.maximum(
        nearest.sum() / 2 - nearest, _LEAST_MOMENT * largest
    )  # of the rods, so that all moments are above zero
    return np.asarray(parts.sum() - parts)
