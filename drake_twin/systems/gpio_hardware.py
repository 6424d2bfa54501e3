"""The simulated hardware behind a robot's GPIOs."""

from collections.abc import Mapping, Sequence
from math import nan

import numpy as np
from pydrake.systems.framework import BasicVector, Context, DiscreteStateIndex, DiscreteValues, InputPort, OutputPort

from drake_twin.dataclass import dataclass
from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem


@dataclass(frozen=True)
class GpioState:
    """A state interface of a GPIO.

    Attributes:
        initial_value: Its value at the start; NaN without one.
        command: The index of the command that it follows; -1 for an input, which keeps its value.
    """

    initial_value: float = nan
    command: int = -1


class GpioHardware(WitnesslessSystem):
    """Hold what controllers write to GPIOs, and let each state follow the command of the same name.

    Behaves as ``mock_components/GenericSystem`` in ROS 2 Jazzy, read and written at each update of the controller
    manager: a state has the value that was written one update before. A command holds until another is written, also
    after its controller is deactivated; NaN writes nothing. Upstream, an infinite command is an error of the hardware;
    here it is not written. A state without a command keeps its initial value.

    .. pydrake_system::

        name: GpioHardware
        input_ports:
        - <controller>
        output_ports:
        - gpio_states

    - ``<controller>``, one port for each: that controller's ``command_interfaces``; NaN where it writes nothing.
    - ``gpio_states``: vector of all state interfaces; NaN for one without a value.

    Args:
        commands: The value of each command interface at the start; NaN without one.
        states: The state interfaces.
        sources: Controller name → for each value of its port the index of the command interface that it writes; -1
            where it writes none.
        period: The time between two updates (s).
    """

    def __init__(
        self,
        commands: Sequence[float],
        states: Sequence[GpioState],
        sources: Mapping[str, Sequence[int]],
        period: float,
    ):
        super().__init__()
        self._num_commands = len(commands)
        self._followed = np.array([state.command for state in states], dtype=int)
        self._sources = [(self.DeclareVectorInputPort(name, len(where)), where) for name, where in sources.items()]
        initial = [*commands, *(state.initial_value for state in states)]
        self._values: DiscreteStateIndex = self.DeclareDiscreteState(initial)
        self.DeclarePeriodicDiscreteUpdateEvent(period, 0.0, weakly(self._update))
        self._states = self.DeclareVectorOutputPort(
            "gpio_states", len(states), weakly(self._calc_states), {self.discrete_state_ticket(self._values)}
        )

    def get_controller_input_port(self, controller: str) -> InputPort:
        """Return the port of one controller."""
        return self.GetInputPort(controller)

    def get_gpio_states_output_port(self) -> OutputPort:
        """Return the port ``gpio_states``."""
        return self._states

    def commands(self, context: Context) -> np.ndarray:
        """Return the value of each command interface; NaN where none was written."""
        return self.values(context)[: self._num_commands]

    def values(self, context: Context) -> np.ndarray:
        """Return the state: the value of each command interface, then of each state interface."""
        values: np.ndarray = context.get_discrete_state(self._values).value()
        return values

    def set_values(self, context: Context, values: Sequence[float]) -> None:
        """Set what `values` returned.

        Raises:
            ValueError: If the number of values is wrong.
        """
        if len(values) != len(self.values(context)):
            raise ValueError(f"there are {len(self.values(context))} values of GPIOs")
        context.SetDiscreteState(self._values, values)

    def _update(self, context: Context, state: DiscreteValues) -> None:
        commands, states = np.split(self.values(context).copy(), [self._num_commands])
        for index, followed in enumerate(self._followed):
            if followed >= 0 and np.isfinite(commands[followed]):
                states[index] = commands[followed]
        for port, where in self._sources:
            for value, index in zip(port.Eval(context), where, strict=True):
                if index >= 0 and np.isfinite(value):
                    commands[index] = value
        state.set_value(self._values, np.concatenate((commands, states)))

    def _calc_states(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self.values(context)[self._num_commands :])
