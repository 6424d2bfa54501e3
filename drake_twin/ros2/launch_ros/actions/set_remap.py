"""Sets a remapping of all nodes."""

from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.node_settings import add_global


@expose_action("set_remap")
class SetRemap(Action):
    """Sets a remapping of all nodes that follow, to the end of the scope."""

    def __init__(self, src: SomeSubstitutionsType, dst: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.src = normalize_to_list_of_substitutions(src)
        self.dst = normalize_to_list_of_substitutions(dst)

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<set_remap>``."""
        _, arguments = super().parse(entity, parser)

        pair = parser.parse_required(entity, "from", "to")
        return cls, {**arguments, "src": pair["from"], "dst": pair["to"]}

    def execute(self, context: LaunchContext) -> None:
        """Set the remapping."""
        pair = (context.perform_substitution(self.src), context.perform_substitution(self.dst))
        add_global(context, "ros_remaps", pair)
