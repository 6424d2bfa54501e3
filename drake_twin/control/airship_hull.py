"""What air does to an airship's hull: the forces of gz-sim's LighterThanAirDynamics, of a body that points along x."""

from collections.abc import Sequence

import numpy as np

from drake_twin.control.cross_product import cross
from drake_twin.dataclass import dataclass

_SMALL = 1e-6  # rad/s and m/s


@dataclass(frozen=True)
class HullCoefficients:
    """The coefficients of a hull.

    Attributes:
        density: Of the air (kg/m³).
        force_inviscid: Of the force of potential flow (m²).
        force_viscous: Of that of viscous flow (m²).
        moment_inviscid: Of the moment of potential flow (m³).
        moment_viscous: Of that of viscous flow (m³).
        eps_v: Where the flow stops to be potential, behind the link's origin (m).
        axial_drag: Of the drag along the hull (m²).
    """

    density: float
    force_inviscid: float
    force_viscous: float
    moment_inviscid: float
    moment_viscous: float
    eps_v: float
    axial_drag: float


class AirshipHulls:
    """The forces of air on several hulls.

    Args:
        hulls: Their coefficients.
    """

    def __init__(self, hulls: Sequence[HullCoefficients]):
        rows = [
            (
                hull.density / 2.0,
                hull.force_inviscid,
                hull.force_viscous,
                hull.moment_inviscid,
                hull.moment_viscous,
                hull.eps_v,
                hull.axial_drag,
            )
            for hull in hulls
        ]
        self._values = np.array(rows)

    def calc(self, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the wrenches (n×6), and how much smaller each becomes with each velocity (n×6×6).

        Args:
            velocity: The velocities relative to the air (n×6), angular first.
        """
        moved = velocity[:, None, :] + _SMALL * np.concatenate([np.zeros((1, 6)), np.eye(6), -np.eye(6)])
        found = self._wrenches(moved.reshape(-1, 6), np.repeat(self._values, 13, axis=0)).reshape(-1, 13, 6)
        slope = (found[:, 7:] - found[:, 1:7]) / (2.0 * _SMALL)
        return found[:, 0], slope.transpose(0, 2, 1)

    @staticmethod
    def _wrenches(velocity: np.ndarray, values: np.ndarray) -> np.ndarray:
        half, force_inviscid, force_viscous, moment_inviscid, moment_viscous, eps_v, axial_drag = values.T
        behind = np.zeros((len(velocity), 3))
        behind[:, 0] = -eps_v
        local = velocity[:, 3:] + cross(velocity[:, :3], behind)
        across = np.hypot(local[:, 1], local[:, 2])
        sine, cosine = across, local[:, 0]  # of the angle of attack, times the speed
        force = half * (force_viscous * sine * sine - 2.0 * force_inviscid * sine * cosine)
        moment = half * (moment_viscous * sine * sine - 2.0 * moment_inviscid * sine * cosine)
        normal = local[:, 1:] / np.where(across > 0.0, across, 1.0)[:, None]
        found = np.zeros_like(velocity)
        found[:, 1], found[:, 2] = moment * normal[:, 1], -moment * normal[:, 0]
        found[:, 4:] = -force[:, None] * normal
        u, w = velocity[:, 3], velocity[:, 5]
        squared = u * u + velocity[:, 4] ** 2 + w * w
        part = u * u + w * w
        found[:, 3] = -half * axial_drag * squared * u * np.abs(u) / np.where(part > 0.0, part, 1.0)
        return found
