"""How often the parts of a robot are updated, in whole physics steps."""

from math import ceil, nextafter

from drake_twin.planning.controller_plan import ControllerPlan

_MOST_STEPS = 1e15


def whole_steps(rate: float, time_step: float) -> int:
    """Return the number of physics steps from one update to the next at a rate (Hz), as Gazebo counts them."""
    return max(1, ceil(min(1.0 / rate / time_step, _MOST_STEPS) - 1e-6))


def published_rate(period: float) -> float:
    """Return the rate (Hz) of what is published once in a period (s), without the rounding of the period."""
    return round(1.0 / period, 9)


def update_steps(item: ControllerPlan, per_cycle: int, time_step: float) -> int:
    """Return the number of physics steps from one update of a controller to the next.

    The controller manager updates it in the cycle, of so many steps, whose time is closest to the controller's rate.
    """
    if item.wiring is not None:
        return whole_steps(item.update_rate, time_step)
    cycles = ceil(1.0 / (item.update_rate * per_cycle * time_step) - 0.5 - 1e-6)
    return per_cycle * max(1, cycles)


def update_period(steps: int, time_step: float) -> float:
    """Return the time of a number of steps (s), rounded so that no multiple of it is later than its step.

    As doubles, five steps of 5 ms are 3e-18 s more than a product of five: one update in six would come after the
    plant's step of the same time, and act one step later.
    """
    period = steps * time_step
    (above, below), (step_above, step_below) = period.as_integer_ratio(), time_step.as_integer_ratio()
    return period if above * step_below <= steps * step_above * below else nextafter(period, 0.0)
