"""What a system keeps of the physics' last step when the plant is built anew."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import AbstractStateIndex, Context


@dataclass(frozen=True)
class _Remembered:
    """Values and the time at which they hold (s)."""

    time: float | None = None
    values: tuple[float, ...] = ()


class LastStep:
    """Values of the last step, which a plant that has just been built does not know until its first.

    They live in an abstract state of the system and hold at the time at which they were remembered.

    Args:
        declare_abstract_state: the system's ``DeclareAbstractState``.
    """

    def __init__(self, declare_abstract_state: Callable[[AbstractValue], AbstractStateIndex]):
        self.index = declare_abstract_state(AbstractValue.Make(_Remembered()))

    def remember(self, context: Context, values: np.ndarray) -> None:
        """Values that hold at the present time."""
        context.SetAbstractState(int(self.index), _Remembered(context.get_time(), tuple(map(float, values))))

    def recall(self, context: Context) -> np.ndarray | None:
        """What was remembered at the present time; None if nothing was."""
        remembered: _Remembered = context.get_abstract_state(int(self.index)).get_value()
        return np.array(remembered.values) if remembered.time == context.get_time() else None
