"""What an event does by itself, beside running its handlers."""

from typing import Any

from drake_twin.ros2.launch.event import Event
from drake_twin.ros2.launch.events.include_launch_description import IncludeLaunchDescription
from drake_twin.ros2.launch.events.shutdown import Shutdown
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch_ros.events.lifecycle import ChangeState, StateTransition
from drake_twin.ros2.lifecycle_msgs.msg import Transition
from drake_twin.ros2.visiting import visit_all

# The transition's number → its name, the state that it goes through, and the state that it ends in.
_STATES = {
    Transition.TRANSITION_CONFIGURE: ("configure", "configuring", "inactive"),
    Transition.TRANSITION_CLEANUP: ("cleanup", "cleaningup", "unconfigured"),
    Transition.TRANSITION_ACTIVATE: ("activate", "activating", "active"),
    Transition.TRANSITION_DEACTIVATE: ("deactivate", "deactivating", "inactive"),
    Transition.TRANSITION_UNCONFIGURED_SHUTDOWN: ("shutdown", "shuttingdown", "finalized"),
    Transition.TRANSITION_INACTIVE_SHUTDOWN: ("shutdown", "shuttingdown", "finalized"),
    Transition.TRANSITION_ACTIVE_SHUTDOWN: ("shutdown", "shuttingdown", "finalized"),
}


def emit(context: LaunchContext, event: Event) -> None:
    """Run the handlers of an event, and do what the event asks for.

    A lifecycle node's transition is taken to happen when it is asked for: the twin does not run the node.
    """
    if isinstance(event, Shutdown):
        context.events.shut_down(event)
        return
    context.events.dispatch(event)
    if isinstance(event, IncludeLaunchDescription):
        visit_all(event.launch_description, context)
    elif isinstance(event, ChangeState):
        name, start, goal = _STATES.get(event.transition_id, ("", "", ""))
        nodes: list[Any] = context.get_locals_as_dict().get("lifecycle_nodes", [])
        for node in nodes:
            if event.lifecycle_node_matcher(node):
                emit(context, StateTransition(action=node, start_state=start, goal_state=goal, asked=name))
