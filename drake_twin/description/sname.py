"""The names of hydrodynamic coefficients in SNAME's notation, as gz-sim's Hydrodynamics has them."""

import re

from drake_twin.dataclass import dataclass

FORCES, VELOCITIES = "kmnxyz", "PQRUVW"
_NAME = re.compile(f"([{FORCES}])(Dot)?([{VELOCITIES}])(?:(abs)?([{VELOCITIES}]))?")


@dataclass(frozen=True)
class CoefficientName:
    """What the name of a coefficient says; axes are indices into `FORCES` and `VELOCITIES`.

    Attributes:
        force: The axis of the wrench.
        velocity: The axis of the velocity, or of the acceleration.
        other: The axis of a second velocity; None for a linear coefficient.
        is_absolute: Whether the size of that counts.
        is_added_mass: Whether it is of the acceleration.
    """

    force: int
    velocity: int
    other: int | None
    is_absolute: bool
    is_added_mass: bool


def coefficient_name(name: str) -> CoefficientName | None:
    """Read ``xU``, ``xUabsU``, ``xUV`` or ``xDotU`` with any axes; None for another name."""
    match = _NAME.fullmatch(name)
    if match is None or (match[2] and match[5]):
        return None
    other = None if match[5] is None else VELOCITIES.index(match[5])
    return CoefficientName(FORCES.index(match[1]), VELOCITIES.index(match[3]), other, bool(match[4]), bool(match[2]))
