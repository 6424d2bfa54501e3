"""An action of a node or of another program, as a node asks it."""

from collections.abc import Callable
from math import inf
from typing import Any

from drake_twin.messages.interface_types import make
from drake_twin.nodes.graph import Graph
from drake_twin.nodes.graph_items import Caller, GoalListener, Reception


class OutsideAction:
    """The three services of an action, its feedback and its goals' statuses.

    Args:
        graph: What node programs share.
        name: The action's full name.
        type: Its ROS type.
        node: The full name of the node that asks.

    Attributes:
        parts: What the node has on the graph for it.
    """

    def __init__(self, graph: Graph, name: str, type: str, node: str):
        self._graph, self.name, self.type, self.node = graph, name, type, node
        self._listeners: dict[bytes, GoalListener] = {}
        services = {
            "send_goal": f"{type}_SendGoal",
            "cancel_goal": "action_msgs/srv/CancelGoal",
            "get_result": f"{type}_GetResult",
        }
        self._callers = {key: Caller(f"{name}/_action/{key}", kind, node) for key, kind in services.items()}
        feedback = Reception(f"{name}/_action/feedback", f"{type}_FeedbackMessage", node, self._hear)
        status = Reception(f"{name}/_action/status", "action_msgs/msg/GoalStatusArray", node, self._follow, True)
        self.parts: tuple[Caller | Reception, ...] = (*self._callers.values(), feedback, status)
        graph.subscribe(feedback)
        graph.subscribe(status)
        for caller in self._callers.values():
            graph.outside.add(caller)

    @property
    def is_there(self) -> bool:
        """Whether a node or another program offers it."""
        return all(self._graph.has_service(item.name, item.type) for item in self._callers.values())

    def close(self) -> None:
        """Take it off the graph."""
        for part in self.parts:
            self._graph.withdraw(part)

    def put_goal(self, key: bytes, goal: Any, listener: GoalListener) -> None:
        """Send a goal."""
        self._listeners[key] = listener
        request = {"goal_id": {"uuid": list(key)}, "goal": goal}
        self._ask("send_goal", request, lambda answer: listener.answered(bool(answer.accepted), answer.stamp))

    def put_cancel(self, key: bytes, answered: Callable[[Any], None]) -> None:
        """Ask to cancel a goal."""
        self._ask("cancel_goal", {"goal_info": {"goal_id": {"uuid": list(key)}}}, answered)

    def put_result(self, key: bytes, answered: Callable[[Any], None]) -> None:
        """Ask for a goal's result; its feedback is not heard any more once that has come."""

        def ended(response: Any) -> None:
            self._listeners.pop(key, None)
            answered(response)

        self._ask("get_result", {"goal_id": {"uuid": list(key)}}, ended)

    def _follow(self, message: Any, expires: float = inf) -> None:
        for item in message.status_list:
            listener = self._listeners.get(bytes(item.goal_info.goal_id.uuid))
            if listener is not None:
                listener.moved(int(item.status))

    def _hear(self, message: Any, expires: float = inf) -> None:
        listener = self._listeners.get(bytes(message.goal_id.uuid))
        if listener is not None:
            listener.heard(message.feedback)

    def _ask(self, service: str, request: Any, answered: Callable[[Any], None]) -> None:
        caller = self._callers[service]
        self._graph.ask(caller.name, caller.type, make(f"{caller.type}_Request", request), answered)
