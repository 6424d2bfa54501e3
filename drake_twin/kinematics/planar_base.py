"""The pose and velocity of a base that moves over the plane on joints, from the joints' state."""

from collections.abc import Sequence
from dataclasses import replace
from math import cos, sin

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import Pose
from drake_twin.kinematics.rotations import quaternion_from_rpy


@dataclass(frozen=True)
class PlanarBase:
    """The indices of such a base's joints in its model instance's state ``[q; v]``.

    The joints are three slides along x, y (rotated by the start's yaw) and z, and a rotation about z.

    Attributes:
        start: The pose of the root link in the world with the joints at zero.
        positions: The indices of their positions (m, m, m, rad).
        velocities: The indices of their velocities (m/s, m/s, m/s, rad/s).
    """

    start: Pose
    positions: tuple[int, ...]
    velocities: tuple[int, ...]

    def within(self, indices: Sequence[int]) -> "PlanarBase":
        """Return the same indices in the plant's state; see `StateLayout.within`."""
        positions, velocities = ([indices[index] for index in own] for own in (self.positions, self.velocities))
        return replace(self, positions=tuple(positions), velocities=tuple(velocities))

    def as_floating(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the state of a floating base with the same pose and velocity.

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
