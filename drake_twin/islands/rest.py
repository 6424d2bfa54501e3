"""Which movers have come to rest, so that what they stand in need not be stepped."""

from collections.abc import Collection, Mapping, Sequence

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
        self._movers = movers
        places = [mover.places.state[mover.places.state >= first] for mover in movers]
        self._velocities = places
        self._starts = np.cumsum([0, *map(len, places)])[:-1]
        self._every = np.concatenate(places) if places else np.empty(0, dtype=int)
        self._has_none = np.array([not len(own) for own in places], dtype=bool)
        self.times = np.zeros(len(movers))

    @property
    def rested(self) -> np.ndarray:
        """Which movers have been still for long enough, shape (movers,)."""
        rested: np.ndarray = self.times >= UNTIL_REST
        return rested

    def wake(self, numbers: Collection[int]) -> None:
        """Count from zero for these movers."""
        self.times[list(numbers)] = 0.0

    def pass_time(self, state: np.ndarray, duration: float) -> np.ndarray:
        """Count for a time (s), after which the plant's state is this; return which movers have come to rest now."""
        before = self.rested
        if len(self._every):
            fastest = np.maximum.reduceat(np.abs(state[self._every]), self._starts)
            still = fastest < STILL
            self.times = np.where(still, np.minimum(self.times + duration, UNTIL_REST), 0.0)
        rested: np.ndarray = self.rested & ~before
        return rested

    def velocities(self, number: int) -> np.ndarray:
        """Return the places of a mover's velocities in the plant's state."""
        return self._velocities[number]

    def state(self) -> dict[str, float]:
        """Return for how long movers have been still, as plain data; those that move are left out."""
        return {mover.name: float(time) for mover, time in zip(self._movers, self.times, strict=True) if time > 0.0}

    def set_state(self, times: Mapping[str, float]) -> None:
        """Set what `state` returned."""
        self.times = np.array([times.get(mover.name, 0.0) for mover in self._movers])
