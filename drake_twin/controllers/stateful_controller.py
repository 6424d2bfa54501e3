"""The base of controllers with a memory."""

from collections.abc import Callable, Collection
from dataclasses import replace
from math import isnan, nan
from typing import Any

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import AbstractStateIndex, Context, EventStatus, State

from drake_twin.controllers.base_controller import Controller, ControllerSetup
from drake_twin.controllers.interface import Interface
from drake_twin.dataclass import dataclass
from drake_twin.frozen import Frozen
from drake_twin.saved import saved
from drake_twin.systems.no_message import empty_value, set_value
from drake_twin.systems.weak_callback import weakly


@saved("Sample")
@dataclass(frozen=True)
class Sample(Frozen):
    """The one abstract state of a stateful controller.

    Attributes:
        active: Whether the controller is updated.
        time: The time of the last update or of the activation (s).
        memory: The subclass's own frozen value; register its class with `drake_twin.saved.saved`.
        commands: The values on ``command_interfaces``.
        fault: Why the last update failed.
    """

    active: bool = False
    time: float = 0.0
    memory: Any = None
    commands: tuple[float, ...] = ()
    fault: str | None = None


class StatefulController(Controller):
    """Keep all state in one `Sample` in the Context: a saved Context is a saved controller.

    A controller that has never been active has no periodic event: each costs Drake a copy of the diagram's state. When
    one is added later, a Simulator has to be initialized again before it advances.

    Attributes:
        new_events: Where it notes that it has added an event, which a simulator may not know yet.
        is_updated: Whether it has been active, so that steps may change its state.
    """

    def __init__(self, setup: ControllerSetup, feedforward: tuple[Interface, ...] = (), initial: Sample | None = None):
        super().__init__(setup, feedforward)
        initial = initial or Sample()
        self.new_events: list[str] = []
        self.is_updated = False
        if setup.active_at_start:
            initial = replace(initial, active=True, time=nan)
            self.DeclareInitializationUnrestrictedUpdateEvent(weakly(self._start))
            self._be_updated()
        self._sample_index: AbstractStateIndex = self.DeclareAbstractState(AbstractValue.Make(initial))

    def sample(self, context: Context) -> Sample:
        """Return the state after the last update."""
        sample: Sample = context.get_abstract_state(int(self._sample_index)).get_value()
        return sample

    def declare_updates(self) -> bool:
        """Declare the periodic event of a controller that has one; return whether it has."""
        return False

    def deactivate(self, context: Context) -> None:
        """Stop; what the controller keeps stays."""
        self.set_sample(context, replace(self.sample(context), active=False))

    def set_sample(self, context: Context, sample: Sample) -> None:
        """Set the state, for example that of a saved run."""
        if sample.active:
            self._be_updated()
        context.SetAbstractState(int(self._sample_index), sample)

    def set_memory(self, context: Context, memory: Any) -> None:
        """Set the memory, and leave the rest of the state as it is."""
        self.set_sample(context, replace(self.sample(context), memory=memory))

    def sample_ticket(self) -> Any:
        """Return the dependency ticket of an output port that follows from the last update."""
        return self.abstract_state_ticket(self._sample_index)

    def declare_message_output(self, topic: str, kind: str, message: Any, prerequisites: Collection[Any] = ()) -> None:
        """Declare an output port that holds a message while the controller is active, and None else.

        Args:
            topic: The topic below the controller's name.
            kind: Its ROS message type.
            message: A method that returns the message for a context, or None.
            prerequisites: The dependency tickets beside that of the last update.
        """
        self.published[topic] = kind
        calc = weakly(self._calc_message, message.__func__)
        self.DeclareAbstractOutputPort(topic, empty_value, calc, {self.sample_ticket(), *prerequisites})

    def _calc_message(self, message: Callable[..., Any], context: Context, output: AbstractValue) -> None:
        set_value(output, message(self, context) if self.sample(context).active else None)

    def _be_updated(self) -> None:
        if not self.is_updated:
            self.is_updated = True
            if self.declare_updates():
                self.new_events.append(self.setup.name)

    def _start(self, context: Context, state: State) -> EventStatus:
        """Activate a controller that is active in a new Context, as when the diagram runs in a Simulator of its own."""
        if not isnan(self.sample(context).time):
            return EventStatus.DidNothing()
        self.activate(context)
        state.get_mutable_abstract_state(int(self._sample_index)).set_value(self.sample(context))
        return EventStatus.Succeeded()

    def fault(self, context: Context) -> str | None:
        """Return why the last update failed; None if it did not."""
        return self.sample(context).fault
