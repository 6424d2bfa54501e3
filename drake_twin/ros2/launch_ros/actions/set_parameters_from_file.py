"""Sets the parameters of a file for all nodes."""

from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch_ros.parameter_descriptions import ParameterFile
from drake_twin.ros2.node_settings import add_global


@expose_action("set_parameters_from_file")
class SetParametersFromFile(Action):
    """Sets the parameters of a file for all nodes that follow, to the end of the scope."""

    _required = ("filename",)

    def __init__(self, filename: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.filename = filename

    def execute(self, context: LaunchContext) -> None:
        """Set the parameters."""
        file = self.filename if isinstance(self.filename, ParameterFile) else ParameterFile(self.filename)
        add_global(context, "global_params", file.read(context))
