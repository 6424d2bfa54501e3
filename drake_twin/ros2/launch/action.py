"""Actions: entities that do something when they are visited."""

from collections.abc import Iterable
from typing import Any, ClassVar

from drake_twin.ros2.launch.conditions.if_condition import IfCondition, UnlessCondition
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.launch_description_entity import LaunchDescriptionEntity
from drake_twin.ros2.places import place_of_caller


class Action(LaunchDescriptionEntity):
    """An entity that does something when it is visited, if its condition holds.

    Args:
        condition: A condition, or None.
    """

    # The attributes of the action's element that the constructor takes as substitutions, and those that it may lack.
    _required: ClassVar[tuple[str, ...]] = ()
    _optional: ClassVar[tuple[str, ...]] = ()

    def __init__(self, *, condition: Any = None):
        if condition is not None and not callable(getattr(condition, "evaluate", condition)):
            raise TypeError(f"condition= takes a condition such as IfCondition, and got {condition!r}")
        self._condition = condition
        self.place = place_of_caller()

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for an element of a launch file: its condition, and what a class names.

        Raises:
            InputError: If an attribute is missing or wrong.
        """
        given = parser.parse_optional(entity, "if", "unless")
        if len(given) == 2:
            raise entity.error("if and unless cannot both be given")
        arguments: dict[str, Any] = {}
        if given:
            condition = IfCondition(given["if"]) if "if" in given else UnlessCondition(given["unless"])
            arguments["condition"] = condition
        arguments |= parser.parse_required(entity, *cls._required)
        return cls, arguments | parser.parse_optional(entity, *cls._optional)

    @property
    def condition(self) -> Any:
        """The condition, or None."""
        return self._condition

    def visit(self, context: LaunchContext) -> Iterable[Any] | None:
        """Execute the action if its condition holds."""
        if self._condition is None or self._condition.evaluate(context):
            return self.execute(context)
        return None

    def execute(self, context: LaunchContext) -> Iterable[Any] | None:
        """Do what the action is for; return the entities to visit next."""
        return None
