"""Sets the folder of the log files."""

from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType


@expose_action("set_ros_log_dir")
class SetROSLogDir(Action):
    """Sets the folder of the log files."""

    def __init__(self, new_log_dir: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.new_log_dir = new_log_dir

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<set_ros_log_dir>``."""
        _, arguments = super().parse(entity, parser)

        return cls, {**arguments, **parser.parse_required(entity, "new_log_dir")}

    def execute(self, context: LaunchContext) -> None:
        """Set the folder."""
        context.environment["ROS_LOG_DIR"] = context.perform_substitution(self.new_log_dir)
