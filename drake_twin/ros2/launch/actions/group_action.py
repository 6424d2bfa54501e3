"""Actions with configurations of their own."""

from collections.abc import Iterable, Mapping
from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.actions.reset_launch_configurations import kept_configurations
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.utilities.normalize_to_list_of_entities_impl import normalize_to_list_of_entities
from drake_twin.ros2.visiting import visit_list


@expose_action("group")
class GroupAction(Action):
    """Actions with configurations of their own.

    Args:
        actions: The actions.
        scoped: Whether what they set ends with the group.
        forwarding: Whether they see what is set outside.
        launch_configurations: Configurations to set first.
    """

    def __init__(
        self,
        actions: Iterable[Any],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[Any, Any] | None = None,
        **kwargs: Any,
    ):
        super().__init__(**kwargs)
        self.actions = normalize_to_list_of_entities(actions)
        self.scoped = scoped
        self.forwarding = forwarding
        self.launch_configurations = dict(launch_configurations or {})

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<group>``."""
        _, arguments = super().parse(entity, parser)

        kept = kept_configurations(entity, parser)
        actions = [parser.parse_action(child) for child in entity.children if child.type_name != "keep"]
        for name in ("scoped", "forwarding"):
            flag = entity.get_flag(name)
            if flag is not None:
                arguments[name] = flag
        return cls, {**arguments, "actions": actions, "launch_configurations": kept}

    def describe_conditional_sub_entities(self) -> list[tuple[str, list[Any]]]:
        """Return the actions, where the group has a condition."""
        return [("the group's condition", self.actions)] if self.condition is not None else []

    def describe_sub_entities(self) -> list[Any]:
        """Return the actions, where the group has no condition."""
        return self.actions if self.condition is None else []

    def get_sub_entities(self) -> list[Any]:
        """Return the actions."""
        return self.actions

    def execute(self, context: LaunchContext) -> None:
        """Visit the actions."""
        if self.scoped:
            with context.scopes.scope():
                self._visit(context)
        else:
            self._visit(context)

    def _visit(self, context: LaunchContext) -> None:
        values = {
            context.perform_substitution(name): context.perform_substitution(value)
            for name, value in self.launch_configurations.items()
        }
        if self.scoped and not self.forwarding:
            context.launch_configurations.clear()
            context.scopes.reset_environment()
        context.launch_configurations.update(values)
        visit_list(self.actions, context)
