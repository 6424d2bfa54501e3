"""Actions that are executed after a time."""

from collections.abc import Iterable
from typing import Any

from drake_twin.errors import InputError
from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.utilities.normalize_to_list_of_entities_impl import normalize_to_list_of_entities
from drake_twin.ros2.visiting import visit_list


@expose_action("timer")
class TimerAction(Action):
    """Actions that are executed after a time.

    Args:
        period: Simulated seconds.
        actions: The actions.
        cancel_on_shutdown: As in ROS; here nothing starts after a shutdown.
    """

    def __init__(self, *, period: Any, actions: Iterable[Any], cancel_on_shutdown: Any = True, **kwargs: Any):
        super().__init__(**kwargs)
        self.period = period
        self.actions = normalize_to_list_of_entities(actions)
        self._canceled = False

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<timer>``."""
        _, arguments = super().parse(entity, parser)

        period = parser.parse_if_substitutions(entity.get_attr("period", data_type=float))
        return cls, {
            **arguments,
            "period": period,
            "actions": [parser.parse_action(child) for child in entity.children],
        }

    def describe_conditional_sub_entities(self) -> list[tuple[str, list[Any]]]:
        """Return the actions."""
        return [("the timer", self.actions)]

    def cancel(self) -> None:
        """Do not execute the actions any more."""
        self._canceled = True

    def execute(self, context: LaunchContext) -> None:
        """Wait, in simulation time.

        Raises:
            InputError: If the period is not a number of seconds.
        """
        captured = context.snapshot()

        def due() -> None:
            if not self._canceled:
                context.run_captured(captured, self.place, lambda: visit_list(self.actions, context))

        context.events.after(_seconds(context, self.period), due)


class CancelTimer(Action):
    """Cancels a timer."""

    def __init__(self, timer: TimerAction, **kwargs: Any):
        super().__init__(**kwargs)
        self.timer = timer

    def execute(self, context: LaunchContext) -> None:
        """Cancel the timer."""
        self.timer.cancel()


def _seconds(context: LaunchContext, period: Any) -> float:
    value = period if isinstance(period, int | float) else context.perform_substitution(period)
    try:
        return float(value)
    except ValueError:
        raise InputError(f"the timer's period is {value!r}, which is not a number of seconds") from None
