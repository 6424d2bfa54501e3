"""Simulation time as a message."""

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context, OutputPort

from drake_twin import messages
from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem


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
            "clock", lambda: AbstractValue.Make(None), weakly(self._calc_clock), {self.time_ticket()}
        )

    def get_clock_output_port(self) -> OutputPort:
        """Return the port ``clock``."""
        return self._clock

    def _calc_clock(self, context: Context, output: AbstractValue) -> None:
        output.set_value(messages.Clock(clock=messages.time_message(context.get_time())))
