"""Which movers have come to rest, so that what they stand in need not be stepped."""

from collections.abc import Collection, Sequence

import numpy as np

from drake_twin.islands.mover import Mover

# A contact that sticks creeps at less than this (m/s; Drake's stiction tolerance in `drake_twin.diagram.plant`), and
# what slides, rolls or swings is faster (rad/s).
STILL = 1e-5

UNTIL_REST = 0.5  # s of simulated time


class Rest:
    """For how long each mover has been still.

    Args:
        movers: All movers.
        first: The place of the first velocity in the plant's state.

    Attributes:
        times: For how long each has been still (s), up to `UNTIL_REST`.
    """

    def __init__(self, movers: Sequence[Mover], first: int):
        places = [mover.places.state[mover.places.state >= first] for mover in movers]
        self._velocities = places
        self._can_move = np.array([len(own) > 0 for own in places], dtype=bool)
        moving = [own for own in places if len(own)]
        self._starts = np.cumsum([0, *map(len, moving)])[:-1]
        self._every = np.concatenate(moving) if moving else np.empty(0, dtype=int)
        self.times = np.zeros(len(movers))

    @property
    def rested(self) -> np.ndarray:
        """Which movers have been still for long enough, shape (movers,)."""
        rested: np.ndarray = (self.times >= UNTIL_REST) | ~self._can_move
        return rested

    def wake(self, numbers: Collection[int]) -> None:
        """Count from zero for these movers."""
        self.times[list(numbers)] = 0.0

    def pass_time(self, state: np.ndarray, duration: float) -> np.ndarray:
        """Count for a time (s), after which the plant's state is this; return which movers have come to rest now."""
        before = self.rested
        if len(self._every):
            still = np.maximum.reduceat(np.abs(state[self._every]), self._starts) < STILL
            times = np.minimum(self.times[self._can_move] + duration, UNTIL_REST)
            self.times[self._can_move] = np.where(still, times, 0.0)
        rested: np.ndarray = self.rested & ~before
        return rested

    def velocities(self, number: int) -> np.ndarray:
        """Return the places of a mover's velocities in the plant's state."""
        return self._velocities[number]
