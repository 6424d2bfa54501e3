"""The thrust of a propeller in water and the speed that it needs for that, as Fossen and gz-sim's Thruster have them.

The thrust is ``ρ K D⁴ |ω| ω``. Its coefficient K is a constant, or follows the velocity of the water at the propeller:
K = α₁ + α₂ (1 - w) V / (ω D).
"""

from math import copysign, sqrt

from drake_twin.dataclass import dataclass


@dataclass(frozen=True)
class Propeller:
    """A propeller.

    Attributes:
        scale: ρ D⁴ (kg·m).
        coefficient: K, or α₁; not zero.
        slope: α₂ (1 - w) / D (1/m).
    """

    scale: float
    coefficient: float
    slope: float = 0.0

    def thrust(self, speed: float, velocity: float) -> float:
        """Return the thrust (N) at a speed (rad/s) and a velocity of the vehicle (m/s)."""
        if speed == 0.0:
            return 0.0
        coefficient = self.coefficient + self.slope * velocity / speed
        return self.scale * coefficient * abs(speed) * speed

    def speed(self, thrust: float, velocity: float) -> float:
        """Return the speed (rad/s) for a thrust (N) at a velocity of the vehicle (m/s).

        It solves ``|T| / (ρ D⁴) = |K| ω²``, where gz-sim takes the K of the step before and so comes to the same.
        """
        size, sign = abs(self.coefficient), copysign(1.0, thrust) if thrust else 0.0
        part = self.slope * velocity
        inner = part * part + 4.0 * size * abs(thrust) / self.scale
        speed = (sign * sqrt(inner) - part) / (2.0 * size) if sign else 0.0
        return copysign(1.0, self.coefficient) * speed
