"""The base of controllers that execute the goals of an action, one at a time."""

from typing import Any

from pydrake.systems.framework import Context, InputPort

from drake_twin.controllers.goal_state import GoalState
from drake_twin.controllers.periodic_controller import PeriodicController


class ActionController(PeriodicController):
    """Execute the goals of an action; a newer goal replaces an older one.

    A goal is accepted when it arrives and is pending until the next update, which executes it. A subclass numbers its
    goals by `newest_id` and implements `used_id`, `last_goal`, `with_canceled_goal` and `with_interrupted_goal`.
    """

    _goal_port: InputPort

    def last_goal(self, memory: Any) -> GoalState | None:
        """Return the state of the last goal that an update has executed; None before the first."""
        raise NotImplementedError

    def with_canceled_goal(self, context: Context, goal: GoalState) -> Any:
        """Return the memory after a cancellation of the goal: the joints stop."""
        raise NotImplementedError

    def with_interrupted_goal(self, context: Context, goal: GoalState) -> Any:
        """Return the memory after a deactivation of the controller has ended the goal."""
        raise NotImplementedError

    def goal_state(self, context: Context) -> GoalState | None:
        """Return the state of the newest goal; None before the first."""
        pending = self.pending(context, self._goal_port)
        if pending is not None:
            return GoalState(pending.id, "accepted")
        memory = self.sample(context).memory
        return None if memory is None else self.last_goal(memory)

    def cancel(self, context: Context) -> None:
        """Cancel the goal that is pending or executed."""
        goal = self._open_goal(context)
        if goal is not None:
            self.set_memory(context, self.with_canceled_goal(context, goal))

    def deactivate(self, context: Context) -> None:
        """End the goal that is pending or executed, then stop writing."""
        goal = self._open_goal(context)
        if goal is not None:
            self.set_memory(context, self.with_interrupted_goal(context, goal))
        super().deactivate(context)

    def _open_goal(self, context: Context) -> GoalState | None:
        goal = self.goal_state(context)
        is_open = self.sample(context).active and goal is not None and not goal.is_done
        return goal if is_open else None
