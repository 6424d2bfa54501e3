"""Declares an argument of the launch file."""

from collections.abc import Iterable
from typing import Any

from drake_twin.errors import InputError
from drake_twin.ros2.described_substitutions import described_text
from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.launched import LaunchArgument
from drake_twin.ros2.text_parts import as_text


@expose_action("arg")
class DeclareLaunchArgument(Action):
    """Declares an argument of the launch file.

    Args:
        name: Its name.
        default_value: Its default; required without one.
        description: What it is for.
        choices: The accepted values.
    """

    def __init__(
        self,
        name: str,
        *,
        default_value: SomeSubstitutionsType | None = None,
        description: str | None = None,
        choices: Iterable[str] | None = None,
        **kwargs: Any,
    ):
        super().__init__(condition=kwargs.pop("condition", None))
        if kwargs:
            raise TypeError(f"DeclareLaunchArgument got an unexpected keyword argument {next(iter(kwargs))!r}")
        self.name = name
        self.default_value = None
        self._refused = ""
        if default_value is not None:
            self.default_value = normalize_to_list_of_substitutions(as_text(default_value))
            if as_text(default_value) is not default_value:
                self._refused = f"the default value of {name!r} is {default_value!r}, which is not text"
        self.description = description or ""
        self.choices = None if choices is None else [str(choice) for choice in choices]

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<arg>``."""
        _, arguments = super().parse(entity, parser)

        choices = [choice.get_attr("value", optional=True) or "" for choice in entity.children_named("choice")]
        default = parser.parse_optional(entity, "default").get("default")
        if entity.get_attr("value", optional=True) is not None:
            entity.refused_by_ros("it has a value, and ROS 2 knows default only")
        return cls, {
            **arguments,
            "name": entity.get_attr("name"),
            "default_value": default,
            "description": entity.get_attr("description", optional=True),
            "choices": choices or None,
        }

    def declared(self) -> LaunchArgument:
        """Return the argument as data."""
        default = None if self.default_value is None else described_text(self.default_value)
        return LaunchArgument(self.name, default, self.description, tuple(self.choices or ()), self.place)

    def execute(self, context: LaunchContext) -> None:
        """Set the default where the argument has no value yet.

        Raises:
            InputError: If it has no value and no default, or a value that is not one of the choices.
        """
        context.declared.add(self.name)
        if self._refused:
            context.refused_by_ros(self._refused)
        if self.name not in context.launch_configurations:
            if self.default_value is None:
                raise InputError(
                    f"the required argument {self.name!r} has no value"
                    + (f" ({self.description})" if self.description else "")
                )
            context.launch_configurations[self.name] = context.perform_substitution(self.default_value)
        value = context.launch_configurations[self.name]
        if self.choices is not None and value not in self.choices:
            raise InputError(
                f"the argument {self.name!r} is {value!r}, which is not one of its choices",
                valid=self.choices,
                value=str(value),
            )
