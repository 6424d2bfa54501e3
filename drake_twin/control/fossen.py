"""The forces of water on a moving body, as Fossen writes them, from coefficients with SNAME's names.

A wrench and a velocity are angular first here, then linear: k, m, n, x, y, z and P, Q, R, U, V, W.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from drake_twin.control.cross_product import cross
from drake_twin.dataclass import dataclass
from drake_twin.description.sname import coefficient_name

_LINEAR = slice(3, 6)


@dataclass(frozen=True)
class Coefficients:
    """A body's coefficients as arrays; the wrench is ``Σ (linear + Σ absolute |ν| + Σ quadratic ν) ν``.

    Attributes:
        linear: Of the wrench and the velocity (6×6).
        absolute: Of the wrench, the velocity and the size of another one (6×6×6).
        quadratic: Of the wrench and two velocities (6×6×6).
        added_mass: The added mass (6×6), which is positive: minus the coefficients with ``Dot``.
    """

    linear: np.ndarray
    absolute: np.ndarray
    quadratic: np.ndarray
    added_mass: np.ndarray


def coefficients_of(named: Mapping[str, float]) -> Coefficients:
    """Return coefficients as arrays.

    Args:
        named: Coefficients by their names.
    """
    found = Coefficients(np.zeros((6, 6)), np.zeros((6, 6, 6)), np.zeros((6, 6, 6)), np.zeros((6, 6)))
    for name, value in named.items():
        axes = coefficient_name(name)
        if axes is None:
            raise ValueError(f"{name!r} is not a coefficient")
        place = axes.force, axes.velocity
        if axes.is_added_mass:
            found.added_mass[place] = -value
        elif axes.other is None:
            found.linear[place] = value
        else:
            (found.absolute if axes.is_absolute else found.quadratic)[(*place, axes.other)] = value
    return found


class Damping:
    """The damping of several bodies.

    Args:
        bodies: Their coefficients.
    """

    def __init__(self, bodies: Sequence[Coefficients]):
        self._linear = np.array([body.linear for body in bodies])
        self._absolute = np.array([body.absolute for body in bodies])
        self._quadratic = np.array([body.quadratic for body in bodies])

    def calc(self, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the wrenches (n×6), and how much smaller each becomes with each velocity (n×6×6).

        Args:
            velocity: The velocities relative to the water (n×6).
        """
        size = np.abs(velocity)
        slope = (self._absolute @ size[:, None, :, None] + self._quadratic @ velocity[:, None, :, None])[..., 0]
        slope += self._linear
        wrench = (slope @ velocity[:, :, None])[:, :, 0]
        # The velocity that a coefficient multiplies stands for j, the other one for k.
        others = np.einsum("nijk,nj->nik", self._absolute, velocity) * np.sign(velocity)[:, None, :]
        others += np.einsum("nijk,nj->nik", self._quadratic, velocity)
        return wrench, -slope - others


def coriolis(inertia: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Return C(ν) ν of Kirchhoff's equations, the wrench that keeps the momentum of an inertia in the world (n×6).

    Args:
        inertia: Symmetric inertias about the bodies' origins, in their axes (n×6×6).
        velocity: Velocities in the same axes (n×6).
    """
    momentum = (inertia @ velocity[:, :, None])[:, :, 0]
    w, v = velocity[:, :3], velocity[:, _LINEAR]
    count = len(velocity)
    products = cross(np.concatenate([w, v, w]), np.concatenate([momentum[:, :3], *[momentum[:, _LINEAR]] * 2]))
    found = np.empty_like(velocity)
    found[:, :3] = products[:count] + products[count : 2 * count]
    found[:, _LINEAR] = products[2 * count :]
    return found
