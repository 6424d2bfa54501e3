"""Launch files of built-in packages as actions."""

from collections.abc import Mapping
from typing import Any

from drake_twin.ros2.built_in_packages import built_in_arguments
from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch_files import enter_built_in_file
from drake_twin.ros2.text_parts import as_text


class BuiltInAction(Action):
    """Starts what a launch file of a built-in package starts.

    Args:
        condition: A condition, or None.
        arguments: The launch file's arguments, by name.

    Attributes:
        file: The launch file, below `drake_twin.ros2.packages.BUILT_IN`.
        more_attributes: Attributes of the action's element that the launch file has no argument for.
    """

    file = ""
    more_attributes: tuple[str, ...] = ()

    def __init__(self, *, condition: Any = None, **arguments: Any):
        super().__init__(condition=condition)
        self._arguments: Mapping[str, Any] = {name: value for name, value in arguments.items() if value is not None}

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for an element with the launch file's arguments."""
        _, arguments = super().parse(entity, parser)
        names = [argument.name for argument in built_in_arguments(cls.file)]
        names += cls.more_attributes
        return cls, {**arguments, **parser.parse_optional(entity, *names)}

    def execute(self, context: LaunchContext) -> None:
        """Do what including the launch file with these arguments does."""
        with context.scopes.scope():
            for name, value in self._arguments.items():
                context.launch_configurations[name] = context.perform_substitution(as_text(value))
            enter_built_in_file(self.file, context, self.place)
