"""Lifecycle nodes' states: a transition is taken to happen when it is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from drake_twin.ros2.events import ChangeState, StateTransition, handle_in

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext


class Transition:
    """The transitions of ``lifecycle_msgs/msg/Transition``."""

    TRANSITION_CREATE = 0
    TRANSITION_CONFIGURE = 1
    TRANSITION_CLEANUP = 2
    TRANSITION_ACTIVATE = 3
    TRANSITION_DEACTIVATE = 4
    TRANSITION_UNCONFIGURED_SHUTDOWN = 5
    TRANSITION_INACTIVE_SHUTDOWN = 6
    TRANSITION_ACTIVE_SHUTDOWN = 7
    TRANSITION_DESTROY = 8


class State:
    """The states of ``lifecycle_msgs/msg/State``."""

    PRIMARY_STATE_UNKNOWN = 0
    PRIMARY_STATE_UNCONFIGURED = 1
    PRIMARY_STATE_INACTIVE = 2
    PRIMARY_STATE_ACTIVE = 3
    PRIMARY_STATE_FINALIZED = 4


_STATES = {
    Transition.TRANSITION_CONFIGURE: ("configuring", "inactive"),
    Transition.TRANSITION_CLEANUP: ("cleaningup", "unconfigured"),
    Transition.TRANSITION_ACTIVATE: ("activating", "active"),
    Transition.TRANSITION_DEACTIVATE: ("deactivating", "inactive"),
    Transition.TRANSITION_UNCONFIGURED_SHUTDOWN: ("shuttingdown", "finalized"),
    Transition.TRANSITION_INACTIVE_SHUTDOWN: ("shuttingdown", "finalized"),
    Transition.TRANSITION_ACTIVE_SHUTDOWN: ("shuttingdown", "finalized"),
}


def change_state(context: LaunchContext, event: ChangeState) -> None:
    """Tells the handlers that the nodes which the event names have changed their state."""
    context.dispatch(event)
    start, goal = _STATES.get(event.transition_id, ("", ""))
    nodes: list[Any] = context.get_locals_as_dict().get("lifecycle_nodes", [])
    for node in nodes:
        if event.lifecycle_node_matcher(node):
            handle_in(context, StateTransition(action=node, start_state=start, goal_state=goal))
