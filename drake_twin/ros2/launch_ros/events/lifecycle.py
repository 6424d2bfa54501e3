"""Events of lifecycle nodes (``launch_ros.events.lifecycle``)."""

from collections.abc import Callable
from typing import Any

from drake_twin.ros2.launch.event import Event
from drake_twin.ros2.launch_ros.events.matchers import matches_node_name

__all__ = ["ChangeState", "StateTransition", "matches_node_name"]


class ChangeState(Event):
    """A lifecycle node is asked to change its state."""

    name = "launch_ros.events.lifecycle.ChangeState"

    def __init__(self, *, lifecycle_node_matcher: Callable[[Any], bool], transition_id: int):
        self.lifecycle_node_matcher = lifecycle_node_matcher
        self.transition_id = transition_id


class StateTransition(Event):
    """A lifecycle node has changed its state."""

    name = "launch_ros.events.lifecycle.StateTransition"

    def __init__(self, *, action: Any, msg: Any = None, start_state: str = "", goal_state: str = ""):
        self.action = action
        self.msg = msg
        self.start_state = start_state
        self.goal_state = goal_state
