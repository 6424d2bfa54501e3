"""The indices of a robot's joints in its model instance's state vector, or in the plant's."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import sqrt

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.kinematics.planar_base import PlanarBase


@dataclass(frozen=True)
class StateLayout:
    """Indices into a model instance's state ``[q; v]`` and actuation ``u``, as on the plant's ports.

    Attributes:
        size: The number of elements of ``[q; v]``.
        positions: Joint name → index of its position (rad or m).
        velocities: Joint name → index of its velocity (rad/s or m/s).
        efforts: Joint name → index of the actuator that drives it (N·m or N); joints without one are left out.
        num_actuators: The number of actuators, including those that model joint friction.
        base_position: Index of the first of a floating base's seven positions (qw, qx, qy, qz, x, y, z); None for any
            other base.
        base_velocity: Index of the first of its six velocities (angular rad/s, then linear m/s, both in the world
            frame).
        planar_base: The joints of a base that moves over the plane; None for any other base.
    """

    size: int
    positions: Mapping[str, int]
    velocities: Mapping[str, int]
    efforts: Mapping[str, int]
    num_actuators: int = 0
    base_position: int | None = None
    base_velocity: int | None = None
    planar_base: PlanarBase | None = None

    def within(self, indices: Sequence[int]) -> "StateLayout":
        """Return the same indices in the plant's state; the size remains that of the model instance's.

        Args:
            indices: The index in the plant's state of each element of the model instance's state.
        """
        planar, base_position, base_velocity = self.planar_base, self.base_position, self.base_velocity
        return replace(
            self,
            positions={name: indices[index] for name, index in self.positions.items()},
            velocities={name: indices[index] for name, index in self.velocities.items()},
            base_position=None if base_position is None else indices[base_position],
            base_velocity=None if base_velocity is None else indices[base_velocity],
            planar_base=None if planar is None else planar.within(indices),
        )

    def place(self, joint: str, interface: str) -> int | None:
        """Return the index of a joint's position, velocity or effort in ``[q; v]`` and the actuators' efforts after it.

        None for another interface, and for the effort of a joint without an actuator.
        """
        if interface == "effort":
            return self.size + self.efforts[joint] if joint in self.efforts else None
        return {"position": self.positions, "velocity": self.velocities}.get(interface, {}).get(joint)

    @property
    def has_moving_base(self) -> bool:
        """Whether the root link moves."""
        return self.base_position is not None or self.planar_base is not None

    def base_state(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the pose and velocity of a moving root link in the world, like those of a floating base.

        Args:
            state: ``[q; v]``; Drake's discrete steps let a quaternion in it grow, as only its direction counts.

        Returns:
            The pose (qw, qx, qy, qz of length 1, x, y, z) and the velocity (angular rad/s, then linear m/s).

        Raises:
            ValueError: If the root link does not move.
        """
        if self.planar_base is not None:
            return self.planar_base.as_floating(state)
        if self.base_position is None or self.base_velocity is None:
            raise ValueError("the root link does not move")
        return np.array(self.base_pose(state)), state[self.base_velocity :][:6]

    def base_pose(self, state: np.ndarray) -> list[float]:
        """Return the pose of `base_state` alone: seven numbers, which take less time one by one than as an array."""
        if self.base_position is None:
            return list(self.base_state(state)[0].tolist())
        turn = state[self.base_position : self.base_position + 4]
        length = sqrt(turn.dot(turn))
        qw, qx, qy, qz, x, y, z = state[self.base_position : self.base_position + 7].tolist()
        return [qw / length, qx / length, qy / length, qz / length, x, y, z]
