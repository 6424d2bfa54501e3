"""Sets a parameter of all nodes."""

from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.launch_ros.parameter_descriptions import ParameterValue
from drake_twin.ros2.node_elements import parse_parameter_value
from drake_twin.ros2.node_settings import add_global
from drake_twin.ros2.parameter_values import typed_value


@expose_action("set_parameter")
class SetParameter(Action):
    """Sets a parameter of all nodes that follow, to the end of the scope."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, **kwargs: Any):
        super().__init__(**kwargs)
        self.name = normalize_to_list_of_substitutions(name)
        self.value = value

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<set_parameter>``."""
        _, arguments = super().parse(entity, parser)

        if "type" in entity:
            entity.refused_by_ros("it has a type, and ROS 2 knows name and value only")
            value = parse_parameter_value(entity, parser)
        else:
            value = parser.parse_required(entity, "value")["value"]
        return cls, {**arguments, **parser.parse_required(entity, "name"), "value": value}

    def execute(self, context: LaunchContext) -> None:
        """Set the parameter.

        Raises:
            InputError: If a parameter cannot have the value.
        """
        name = context.perform_substitution(self.name)
        value = self.value.evaluate(context) if isinstance(self.value, ParameterValue) else self.value
        value = typed_value(context, value, f"parameter {name!r}")
        if isinstance(value, tuple):
            context.log.append(f"SetParameter: ROS passes the list {name!r} on as the text {value!r}")
        add_global(context, "global_params", (name, value))
