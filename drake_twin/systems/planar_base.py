"""The pose and velocity of a base that moves over the plane on joints, from their state."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import cos, sin

import numpy as np

from drake_twin.description.robot_description import Pose
from drake_twin.systems.rotations import quaternion_from_rpy


@dataclass(frozen=True)
class PlanarBase:
    """Where the joints of such a base stand in its model instance's state ``[q; v]``.

    The joints are three slides along x, y (turned by the start's yaw) and z, and a turn about z.

    Attributes:
        start: The root link in the world while they are at zero.
        positions: Indices of their positions (m, m, m, rad).
        velocities: Indices of their velocities (m/s, m/s, m/s, rad/s).
    """

    start: Pose
    positions: tuple[int, ...]
    velocities: tuple[int, ...]

    def within(self, indices: Sequence[int]) -> "PlanarBase":
        """Return where the same stands in the plant's state; as `StateLayout.within`."""
        positions, velocities = ([indices[index] for index in own] for own in (self.positions, self.velocities))
        return replace(self, positions=tuple(positions), velocities=tuple(velocities))

    def as_floating(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what a floating base would have in the same place.

        Returns:
            The pose (qw, qx, qy, qz, x, y, z) and the velocity (angular, then linear; rad/s, m/s) in the world.
        """
        *slides, turn = state[list(self.positions)].tolist()
        *linear, angular = state[list(self.velocities)].tolist()
        roll, pitch, yaw = self.start.rpy
        (quaternion,) = quaternion_from_rpy(np.array([[roll, pitch, yaw + turn]]))
        position = np.add(self.start.xyz, _about_z(yaw, slides))
        return np.concatenate([quaternion, position]), np.array([0.0, 0.0, angular, *_about_z(yaw, linear)])


def _about_z(angle: float, vector: list[float]) -> list[float]:
    x, y, z = vector
    return [cos(angle) * x - sin(angle) * y, sin(angle) * x + cos(angle) * y, z]
