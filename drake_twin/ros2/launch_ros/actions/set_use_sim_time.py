"""Sets whether all nodes use simulation time."""

from typing import Any

from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch_ros.actions.set_parameter import SetParameter
from drake_twin.ros2.node_elements import parse_parameter_value


@expose_action("set_use_sim_time")
class SetUseSimTime(SetParameter):
    """Sets whether all nodes that follow use simulation time."""

    def __init__(self, value: Any, **kwargs: Any):
        super().__init__("use_sim_time", value, **kwargs)

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<set_use_sim_time>``."""
        _, arguments = super(SetParameter, cls).parse(entity, parser)
        return cls, {**arguments, "value": parse_parameter_value(entity, parser)}
