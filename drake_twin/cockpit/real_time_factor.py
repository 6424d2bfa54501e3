"""The real-time factor, measured over the last half second."""

from collections import deque

_WINDOW = 0.5  # s of wall time


class RealTimeFactor:
    """Measures simulated seconds per second of wall time, over about the last half second that was not paused."""

    def __init__(self) -> None:
        self._samples: deque[tuple[float, float]] = deque()

    def note(self, wall_time: float, sim_time: float, *, paused: bool) -> float | None:
        """Add a sample.

        Args:
            wall_time: The wall clock (s).
            sim_time: Simulation time (s).
            paused: Whether the twin is paused.

        Returns:
            The factor; None while paused, and until two samples are far enough apart.
        """
        samples = self._samples
        if paused or (samples and sim_time < samples[-1][1]):  # it was reset
            samples.clear()
        if paused:
            return None
        samples.append((wall_time, sim_time))
        while len(samples) > 2 and samples[1][0] <= wall_time - _WINDOW:
            samples.popleft()
        elapsed = wall_time - samples[0][0]
        return (sim_time - samples[0][1]) / elapsed if elapsed > 0.2 * _WINDOW else None
