"""The motion of free bodies, read from the plant's state at once."""

from collections.abc import Sequence

import numpy as np
from pydrake.multibody.tree import RigidBody

# A rotation, row by row, from the products of two elements of its quaternion (w, x, y, z), row by row.
_SQUARES = {0: (1, 1, -1, -1), 4: (1, -1, 1, -1), 8: (1, -1, -1, 1)}
_PRODUCTS = {
    1: ((1, 2, 1), (0, 3, -1)),
    2: ((1, 3, 1), (0, 2, 1)),
    3: ((1, 2, 1), (0, 3, 1)),
    5: ((2, 3, 1), (0, 1, -1)),
    6: ((1, 3, 1), (0, 2, -1)),
    7: ((2, 3, 1), (0, 1, 1)),
}


def _of_products() -> np.ndarray:
    found = np.zeros((4, 4, 9))
    for place, signs in _SQUARES.items():
        found[range(4), range(4), place] = signs
    for place, terms in _PRODUCTS.items():
        for one, other, sign in terms:
            found[one, other, place] = 2 * sign
    return found.reshape(16, 9)


_OF_PRODUCTS = _of_products()


class FreeBodies:
    """Bodies whose pose is a quaternion and a place in the plant's state.

    Args:
        bodies: The bodies.
        num_positions: The number of the plant's positions.

    Attributes:
        velocities: The place of each one's velocity among the plant's (n×6).
    """

    def __init__(self, bodies: Sequence[RigidBody], num_positions: int):
        first = np.array([body.floating_positions_start() for body in bodies], dtype=int)
        velocity = np.array([body.floating_velocities_start_in_v() for body in bodies], dtype=int)
        self._turns = first[:, None] + np.arange(4)
        self._origins = first[:, None] + np.arange(4, 7)
        self.velocities = velocity[:, None] + np.arange(6)
        self._velocities = num_positions + self.velocities

    @staticmethod
    def has(body: RigidBody) -> bool:
        """Tell whether a body is one."""
        return bool(body.is_floating_base_body() and body.has_quaternion_dofs())

    def read(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return each pose X_WB (n×3×4, m) and each velocity in the world frame (n×6): angular (rad/s), linear (m/s).

        Args:
            state: The plant's ``[q; v]``; the length of a quaternion in it does not count.
        """
        turns = state[self._turns]
        products = turns[:, :, None] * turns[:, None, :]
        lengths = products[:, 0, 0] + products[:, 1, 1] + products[:, 2, 2] + products[:, 3, 3]
        poses = np.empty((len(turns), 3, 4))
        poses[:, :, :3] = (products.reshape(-1, 16) @ _OF_PRODUCTS / lengths[:, None]).reshape(-1, 3, 3)
        poses[:, :, 3] = state[self._origins]
        return poses, state[self._velocities]
