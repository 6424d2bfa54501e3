"""The geometric control of a multicopter's velocity, as in gz-sim's MulticopterVelocityControl.

T. Lee, M. Leok, N. H. McClamroch: *Control of Complex Maneuvers for a Quadrotor UAV using Geometric Methods on SE(3)*,
in the form of RotorS and ``LeeVelocityController.cc`` of gz-sim.
"""

from collections.abc import Sequence

import numpy as np

from drake_twin.control.cross_product import cross
from drake_twin.dataclass import dataclass

_PARALLEL = 1e-3  # the square of the sine between two directions
_RANK = 1e-9  # of the allocation matrix, relative to its largest singular value


@dataclass(frozen=True)
class ControlledRotor:
    """A rotor as the controller knows it.

    Attributes:
        angle: The direction from the body's origin to the rotor, about the body's z axis from x (rad).
        arm: The distance from that axis (m).
        force_constant: The thrust along the body's z axis ÷ the square of its speed (N·s²).
        moment_constant: The moment of drag ÷ the thrust (m).
        direction: 1 for a rotor that turns counter-clockwise, -1 for the other one.
    """

    angle: float
    arm: float
    force_constant: float
    moment_constant: float
    direction: float


@dataclass(frozen=True)
class LeeGains:
    """The gains and limits, named after the elements of the plugin; each has three numbers.

    Attributes:
        velocity: The force for an error of the velocity (N·s/m).
        attitude: The moment for an error of the orientation (N·m).
        angular_rate: The moment for an error of the angular velocity (N·m·s).
        max_acceleration: The largest acceleration for an error of the velocity (m/s²).
    """

    velocity: Sequence[float]
    attitude: Sequence[float]
    angular_rate: Sequence[float]
    max_acceleration: Sequence[float]


class LeeVelocity:
    """Speeds of rotors that give a multicopter a velocity.

    Args:
        rotors: Its rotors.
        gains: The gains.
        mass: Its mass (kg).
        inertia: Its moments of inertia, as gz-sim adds them up (3×3, kg·m²).
        gravity: The acceleration of free fall in the world frame (m/s²).

    Raises:
        ValueError: If the rotors cannot turn the body about all axes and lift it.
    """

    def __init__(
        self,
        rotors: Sequence[ControlledRotor],
        gains: LeeGains,
        mass: float,
        inertia: np.ndarray,
        gravity: np.ndarray,
    ):
        allocation = np.array(
            [
                [
                    np.sin(rotor.angle) * rotor.arm * rotor.force_constant,
                    -np.cos(rotor.angle) * rotor.arm * rotor.force_constant,
                    -rotor.direction * rotor.force_constant * rotor.moment_constant,
                    rotor.force_constant,
                ]
                for rotor in rotors
            ]
        ).T.reshape(4, -1)
        if np.linalg.matrix_rank(allocation, tol=_RANK * max(float(np.abs(allocation).max(initial=0.0)), 1e-300)) < 4:
            raise ValueError("its rotors cannot turn the body about each axis and lift it")
        inverse = np.linalg.inv(inertia)
        self._attitude = np.asarray(gains.attitude) @ inverse
        self._rate = np.asarray(gains.angular_rate) @ inverse
        full = np.zeros((4, 4))
        full[:3, :3], full[3, 3] = inertia, 1.0
        self._to_squares = allocation.T @ np.linalg.inv(allocation @ allocation.T) @ full
        self._velocity = np.asarray(gains.velocity) / mass
        self._most = np.asarray(gains.max_acceleration)
        self._mass, self._gravity = mass, gravity

    def speeds(
        self, R_WB: np.ndarray, velocity: np.ndarray, rates: np.ndarray, linear: np.ndarray, yaw_rate: float
    ) -> np.ndarray:
        """Return the speed of each rotor (rad/s).

        Args:
            R_WB: The body's orientation (3×3).
            velocity: Its velocity in the world frame (m/s).
            rates: Its angular velocity in its own axes (rad/s).
            linear: The velocity that it should have, in its own axes (m/s).
            yaw_rate: The angular velocity about its z axis that it should have (rad/s).
        """
        wanted = np.clip(self._velocity * (velocity - R_WB @ linear), -self._most, self._most) + self._gravity
        turn = self._angular_acceleration(R_WB, rates, yaw_rate, wanted)
        squares = self._to_squares @ np.array([*turn, -self._mass * wanted.dot(R_WB[:, 2])])
        speeds: np.ndarray = np.sqrt(np.maximum(squares, 0.0))
        return speeds

    def _angular_acceleration(
        self, R_WB: np.ndarray, rates: np.ndarray, yaw_rate: float, wanted: np.ndarray
    ) -> np.ndarray:
        up = -wanted / np.linalg.norm(wanted)
        across = cross(up[None, :], R_WB.T)
        left = next(side for side in across if side.dot(side) >= _PARALLEL)
        left = left / np.linalg.norm(left)
        desired = np.array([*cross(left[None, :], up[None, :]), left, up]).T
        twist = 0.5 * (desired.T @ R_WB - R_WB.T @ desired)
        angles = np.array([twist[2, 1], twist[0, 2], twist[1, 0]])
        errors = rates - R_WB.T @ desired @ (0.0, 0.0, yaw_rate)
        turn: np.ndarray = -angles * self._attitude - errors * self._rate
        return turn
