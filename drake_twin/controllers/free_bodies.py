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
    lengths = np.eye(4).reshape(16, 1)  # the sum of the squares
    return np.hstack([found.reshape(16, 9), lengths])


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
        self.velocities = velocity[:, None] + np.arange(6)
        self._places = np.hstack([first[:, None] + np.arange(7), num_positions + self.velocities])

    @staticmethod
    def has(body: RigidBody) -> bool:
        """Tell whether a body is one."""
        return bool(body.is_floating_base_body() and body.has_quaternion_dofs())

    def read(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return each one's orientation R_WB (n×3×3), place (n×3, m), and velocity, all in the world frame.

        The velocity is the angular (rad/s), then that of the origin (m/s), n×6.

        Args:
            state: The plant's ``[q; v]``; the length of a quaternion in it does not count.
        """
        rows = state[self._places]
        turns = rows[:, :4]
        products = (turns[:, :, None] * turns[:, None, :]).reshape(-1, 16) @ _OF_PRODUCTS
        return (products[:, :9] / products[:, 9:]).reshape(-1, 3, 3), rows[:, 4:7], rows[:, 7:]
