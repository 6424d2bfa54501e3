"""Which movers have come to rest, so that what they stand in need not be stepped."""

from collections.abc import Collection, Sequence

import numpy as np

from drake_twin.islands.mover import Mover

# What slides, rolls or swings is faster (m/s, rad/s). A contact that sticks creeps at 1e-5 r / sqrt(1 - r²) m/s, where
# r is the part of its friction that is in use (Drake's stiction tolerance in `drake_twin.diagram.plant`): what uses
# more than 0.7 of it does not rest, and is stepped as in one plant.
STILL = 1e-5

UNTIL_REST = 0.5  # s of simulated time


class Rest:
    """For how long each mover has been still.

    Args:
        movers: All movers.
        first: The place of the first velocity in the plant's state.

    Attributes:
        times: For how long each has been still (s), up to `UNTIL_REST`.
        rested: Which movers have been still for long enough, shape (movers,).
        version: Another number whenever others have.
    """

    def __init__(self, movers: Sequence[Mover], first: int):
        places = [mover.places.state[mover.places.state >= first] for mover in movers]
        self._velocities = places
        self._can_move = np.array([len(own) > 0 for own in places], dtype=bool)
        self.version = 0
        self.set_times(np.zeros(len(movers)))

    def set_times(self, times: np.ndarray) -> None:
        """Set for how long each has been still (s)."""
        self.times = times
        self._count()

    def _count(self) -> None:
        """Count from now on for those that have not been still for long enough; the others do not move."""
        self.rested = (self.times >= UNTIL_REST) | ~self._can_move
        self.version += 1
        self._counted = np.flatnonzero(~self.rested)
        own = [self._velocities[number] for number in self._counted.tolist()]
        self._starts = np.cumsum([0, *map(len, own)])[:-1]
        self._every = np.concatenate(own) if own else np.empty(0, dtype=int)

    def wake(self, numbers: Collection[int]) -> None:
        """Count from zero for these movers."""
        if numbers:
            chosen = list(numbers)
            self.times[chosen] = 0.0
            if (self.rested[chosen] & self._can_move[chosen]).any():
                self._count()

    def pass_time(self, state: np.ndarray, duration: float, stepped: Sequence[int]) -> list[int]:
        """Count for a time (s).

        Args:
            state: The plant's state after it.
            duration: The time.
            stepped: The movers that were stepped, also those that were at rest, which others may have moved.

        Returns:
            Those that have come to rest now.
        """
        beside = [number for number in stepped if self.rested[number] and self._can_move[number]]
        stirred = [number for number in beside if not (np.abs(state[self._velocities[number]]) < STILL).all()]
        if not len(self._counted):
            self.wake(stirred)
            return []
        still = np.maximum.reduceat(np.abs(state[self._every]), self._starts) < STILL
        times = np.where(still, np.minimum(self.times[self._counted] + duration, UNTIL_REST), 0.0)
        self.times[self._counted] = times
        newly: list[int] = self._counted[times >= UNTIL_REST].tolist()
        if newly:
            self._count()
        self.wake(stirred)
        return newly

    def velocities(self, number: int) -> np.ndarray:
        """Return the places of a mover's velocities in the plant's state."""
        return self._velocities[number]
