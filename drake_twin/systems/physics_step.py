"""The length of a plant's steps, also of a plant that only holds the state of robots that are stepped elsewhere.

Drake's Simulator steps each discrete plant of its diagram. A plant whose period is so long that its second step never
comes is left alone: it has no other sign than its period, which keeps the digits of the step.
"""

from pydrake.multibody.plant import MultibodyPlant

_NEVER = 2.0**40  # a step of 50 µs becomes 1.7 years


def held(time_step: float) -> float:
    """Return the period of a plant that holds the state of robots that are stepped elsewhere.

    Args:
        time_step: The length of their steps (s).
    """
    return time_step * _NEVER


def holds_state(plant: MultibodyPlant) -> bool:
    """Tell whether a plant only holds the state of robots that are stepped elsewhere."""
    return bool(plant.time_step() > 1e6)


def physics_step(plant: MultibodyPlant) -> float:
    """Return the length of the steps (s) with which a plant's robots are simulated; 0 for a continuous plant."""
    step = float(plant.time_step())
    return step / _NEVER if holds_state(plant) else step
