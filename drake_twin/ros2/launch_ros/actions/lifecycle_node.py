"""Starts a node with lifecycle states."""

from typing import Any

from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.type_utils import perform_typed_substitution
from drake_twin.ros2.launch_ros.actions.lifecycle_transition import ask_for_transition
from drake_twin.ros2.launch_ros.actions.node import Node
from drake_twin.ros2.lifecycle_msgs.msg import Transition


@expose_action("lifecycle_node")
class LifecycleNode(Node):
    """Starts a node with lifecycle states.

    Args:
        name: The node's name.
        namespace: Its namespace.
        autostart: Whether it is configured and activated at once, as in later distributions than Jazzy.
    """

    def __init__(
        self,
        *,
        name: SomeSubstitutionsType,
        namespace: SomeSubstitutionsType = "",
        autostart: Any = False,
        **kwargs: Any,
    ):
        super().__init__(name=name, namespace=namespace, **kwargs)
        self._autostart = autostart
        self.is_lifecycle = True

    def execute(self, context: LaunchContext) -> None:
        """Start the node."""
        super().execute(context)
        nodes = context.get_locals_as_dict().get("lifecycle_nodes", [])
        context.extend_globals({"lifecycle_nodes": [*nodes, self]})
        if self.started is not None and perform_typed_substitution(context, self._autostart, bool):
            for transition in (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE):
                ask_for_transition(context, self.node_name, transition)
