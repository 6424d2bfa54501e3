"""The goals that are on their way to their end."""

from collections.abc import Callable, Collection
from typing import Any

from drake_twin.diagram.topics import CommandTopic
from drake_twin.twin.action import ActionGoal
from drake_twin.twin.robot_control import RobotControl


class Goals:
    """All goals that have not ended.

    Attributes:
        items: The goals, in the order in which they were sent.
    """

    def __init__(self) -> None:
        self.items: list[ActionGoal] = []

    def add(
        self,
        action: str,
        item: CommandTopic,
        value: Any,
        control: RobotControl,
        on_result: Callable[[ActionGoal], None] | None,
    ) -> ActionGoal:
        """Add a goal that a controller has accepted, and return it."""
        goal = ActionGoal(action, item.type, value.id, control, item.controller, on_result)
        self.items.append(goal)
        return goal

    def deliver(self) -> None:
        """Call back for the goals that have ended."""
        self.items = [goal for goal in self.items if not goal.deliver()]

    def keep(self, controls: Collection[RobotControl]) -> None:
        """Keep the goals of these robots; drop all others."""
        for goal in self.items:
            if not goal.is_of(controls):
                goal.drop()
        self.items = [goal for goal in self.items if goal.is_of(controls)]

    def drop_all(self) -> None:
        """End all goals without a callback."""
        self.keep(())
