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
    """A lifecycle node has changed its state: the two events of ROS, of its beginning and of its end, in one.

    Attributes:
        action: The node.
        start_state: The state that it goes through, such as ``configuring``.
        goal_state: The state that it ends in.
        transition: The name of the event of its end.
        asked: The name of the event of its beginning, such as ``configure``.
    """

    name = "launch_ros.events.lifecycle.StateTransition"

    transition = "transition_success"

    def __init__(self, *, action: Any, msg: Any = None, start_state: str = "", goal_state: str = "", asked: str = ""):
        self.action = action
        self.msg = msg
        self.asked = asked
        self.start_state = start_state
        self.goal_state = goal_state
