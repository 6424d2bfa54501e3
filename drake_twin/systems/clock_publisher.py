"""Simulation time as a message."""

from collections.abc import Callable
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context, OutputPort

from drake_twin import messages
from drake_twin.messages.draft import Draft, Drafter
from drake_twin.systems.no_message import empty_value
from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem

_NOTHING = np.zeros(0)


class ClockPublisher(WitnesslessSystem):
    """Publish simulation time as a ``Clock`` message, like Gazebo's ``/clock``.

    .. pydrake_system::

        name: ClockPublisher
        output_ports:
        - clock

    - ``clock``: ``rosgraph_msgs/msg/Clock``, exact to the nanosecond at any time; topic ``/clock``.
    """

    def __init__(self) -> None:
        super().__init__()
        self._clock = self.DeclareAbstractOutputPort(
            "clock", empty_value, weakly(self._calc_clock), {self.time_ticket()}
        )

    def get_clock_output_port(self) -> OutputPort:
        """Return the port ``clock``."""
        return self._clock

    def drafter(self) -> Drafter:
        """Return what drafts its messages."""
        return Drafter(lambda reading: _NOTHING, lambda nothing: nothing, _clock, 0)

    def draft_at(self) -> Callable[[float], Draft]:
        """Return what drafts the message of any time (s)."""
        drafter = self.drafter()
        return lambda time: drafter.at(time, _NOTHING)

    def _calc_clock(self, context: Context, output: AbstractValue) -> None:
        output.set_value(_clock(context.get_time(), _NOTHING))


def _clock(time: float, _: np.ndarray) -> Any:
    return messages.Clock(clock=messages.time_message(time))
