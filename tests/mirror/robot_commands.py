"""Random commands, as a person or a planner gives them to a rover or an arm."""

from collections.abc import Iterator

import numpy as np

_GRID = 0.05  # s between two commands on a ramp
_AGAIN = 0.5  # s after which an unchanged command is sent again
_REACH = {"low": np.array([-1.2, -0.7, -0.7, -0.25]), "high": np.array([1.2, 0.6, 0.3, 0.65])}  # of the arm (rad)
_FASTEST = np.array([1.0, 0.6, 0.8, 0.6])  # of its joints (rad/s)


def arm_start(generator: np.random.Generator | None) -> np.ndarray:
    """Return the arm's positions at the start (rad)."""
    return np.zeros(4) if generator is None else generator.uniform(_REACH["low"] / 2, _REACH["high"] / 2)


def random_commands(
    kind: str, seed: int, duration: float, *, elsewhere: bool = False
) -> Iterator[tuple[float, np.ndarray]]:
    """Yield commands as a person or a planner gives them: the time at which each is sent (s), velocities (rad/s).

    Every 0.7 to 1.5 s there are other velocities, at once or on a ramp of 0.2 to 0.5 s; one in ten is a pause. They
    depend on the seed alone, and keep a healthy arm within its range.
    """
    generator = np.random.default_rng([seed, 0])
    now, position = np.zeros(4), arm_start(np.random.default_rng([seed, 4]) if elsewhere else None)
    sent = np.zeros(4)
    last = -np.inf
    next_change = float(generator.uniform(0.1, 0.4))
    while next_change < duration:
        start, lasts = next_change, float(generator.uniform(0.7, 1.5))
        ramp = float(generator.uniform(0.2, 0.5)) if generator.random() < 0.6 else 0.0
        is_pause = generator.random() < 0.1
        wanted = _rover_velocities(generator) if kind == "rover" else _arm_velocities(generator, position, lasts)
        wanted = np.zeros(4) if is_pause else wanted
        for time in np.arange(start, min(start + lasts, duration) - 1e-9, _GRID):
            share = 1.0 if ramp == 0.0 else min((time - start + _GRID) / ramp, 1.0)
            velocities = now + share * (wanted - now)
            position = position + _GRID * velocities
            if time - last > _AGAIN - 1e-9 or not np.array_equal(velocities, sent):
                sent, last = velocities, time
                yield float(time), velocities
        now, next_change = wanted, start + lasts


def _rover_velocities(generator: np.random.Generator) -> np.ndarray:
    """Return velocities of its wheels (rad/s), those of each side alike."""
    ahead = generator.uniform(2.0, 8.0) * (1.0 if generator.random() < 0.75 else -1.0)
    turn = generator.uniform(-3.5, 3.5) if generator.random() < 0.8 else 0.0
    return np.array([ahead - turn, ahead + turn, ahead - turn, ahead + turn])


def _arm_velocities(generator: np.random.Generator, position: np.ndarray, lasts: float) -> np.ndarray:
    """Return velocities (rad/s) with which the arm stays within its reach for so long (s)."""
    wanted = _FASTEST * generator.uniform(0.3, 1.0, 4) * generator.choice((-1.0, 1.0), 4)
    wanted *= generator.random(4) >= 0.1
    for joint in range(4):
        low, high = _REACH["low"][joint], _REACH["high"][joint]
        if not low <= position[joint] + wanted[joint] * lasts <= high:
            wanted[joint] = -wanted[joint]
        reached = np.clip(position[joint] + wanted[joint] * lasts, low, high)
        wanted[joint] = (reached - position[joint]) / lasts
    return wanted
