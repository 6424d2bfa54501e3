"""Puts nodes into a namespace."""

from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.launched import joined_namespace

__all__ = ["PushROSNamespace", "PushRosNamespace"]


@expose_action("push_ros_namespace")
class PushRosNamespace(Action):
    """Puts the nodes that follow, to the end of the scope, into a namespace."""

    _required = ("namespace",)

    def __init__(self, namespace: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.namespace = normalize_to_list_of_substitutions(namespace)

    def execute(self, context: LaunchContext) -> None:
        """Push the namespace."""
        base = context.launch_configurations.get("ros_namespace")
        namespace = context.perform_substitution(self.namespace)
        context.launch_configurations["ros_namespace"] = joined_namespace(base, namespace)


PushROSNamespace = PushRosNamespace
