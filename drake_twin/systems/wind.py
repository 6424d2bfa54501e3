"""The wind of a world that changes."""

from typing import Any

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import AbstractStateIndex, BasicVector, Context, OutputPort

from drake_twin import messages
from drake_twin.control.wind import ChangingWind, Velocity, WindState
from drake_twin.systems.no_message import empty_value
from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem


class Wind(WitnesslessSystem):
    """Keep what a changing wind was last told, and compute its velocity.

    .. pydrake_system::

        name: Wind
        output_ports:
        - velocity
        - blows
        - wind_info

    - ``velocity``: the velocity of the air in the world (m/s); where the plant has steps that in the middle of the
      step, since forces are constant in it.
    - ``blows``: 1 while the wind exerts forces by itself, else 0.
    - ``wind_info``: ``geometry_msgs/msg/Vector3``, the velocity at the present time.

    Args:
        wind: How it changes.
        wanted: The velocity that it rises to at the start, in the world (m/s).
        time_step: The plant's step (s); 0 for one without steps.
    """

    def __init__(self, wind: ChangingWind, wanted: Velocity, time_step: float):
        super().__init__()
        self._wind, self._ahead = wind, time_step / 2
        self._state: AbstractStateIndex = self.DeclareAbstractState(AbstractValue.Make(wind.start(wanted)))
        of_state: Any = self.abstract_state_ticket(self._state)
        tickets = {self.time_ticket(), of_state}
        self._velocity = self.DeclareVectorOutputPort("velocity", 3, weakly(self._calc_velocity), tickets)
        self._blows = self.DeclareVectorOutputPort("blows", 1, weakly(self._calc_blows), {of_state})
        self._info = self.DeclareAbstractOutputPort("wind_info", empty_value, weakly(self._calc_info), tickets)

    def get_velocity_output_port(self) -> OutputPort:
        """Return the port ``velocity``."""
        return self._velocity

    def get_blows_output_port(self) -> OutputPort:
        """Return the port ``blows``."""
        return self._blows

    def get_wind_info_output_port(self) -> OutputPort:
        """Return the port ``wind_info``."""
        return self._info

    def state(self, context: Context) -> WindState:
        """Return what it was last told, by its own context."""
        state: WindState = context.get_abstract_state(int(self._state)).get_value()
        return state

    def set_state(self, context: Context, state: WindState) -> None:
        """Replace what it was last told.

        Raises:
            ValueError: If that is something else.
        """
        if not isinstance(state, WindState):
            raise ValueError("the state of the wind is not one")
        context.SetAbstractState(int(self._state), state)

    def tell(self, context: Context, wanted: Velocity | None, *, blows: bool) -> None:
        """Let it rise to a velocity (m/s) from now on, None for that of before; or keep the present one, and not blow.

        Args:
            context: Its own context.
            wanted: The velocity in the world.
            blows: Whether it changes and exerts forces.
        """
        self.set_state(context, self._wind.told(self.state(context), context.get_time(), wanted, blows=blows))

    def present(self, context: Context) -> Velocity:
        """Return the velocity at the present time (m/s)."""
        return self._wind.velocity(self.state(context), context.get_time())

    def _calc_velocity(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._wind.velocity(self.state(context), context.get_time() + self._ahead))

    def _calc_blows(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector([float(self.state(context).blows)])

    def _calc_info(self, context: Context, output: AbstractValue) -> None:
        output.set_value(messages.Vector3(*self.present(context)))
