"""An action of another program, as an action that a node asks."""

from collections.abc import Callable
from functools import partial
from math import inf
from typing import Any

from drake_twin.messages.interface_types import make
from drake_twin.nodes.graph import Graph
from drake_twin.nodes.graph_items import Caller, GoalListener, Reception


class OutsideAction:
    """The three services of an action, and its feedback.

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
        self.parts: tuple[Caller | Reception, ...] = (*self._callers.values(), feedback)
        graph.subscribe(feedback)
        for caller in self._callers.values():
            graph.outside.add(caller)

    @property
    def is_there(self) -> bool:
        """Whether another program offers it, or a node does by services of its own."""
        return all(self._graph.has_service(item.name, item.type) for item in self._callers.values())

    def close(self) -> None:
        """Take it off the graph."""
        for part in self.parts:
            self._graph.withdraw(part)

    def put_goal(self, key: bytes, goal: Any, listener: GoalListener) -> None:
        """Send a goal, and ask for its result once it is accepted."""
        request = {"goal_id": {"uuid": list(key)}, "goal": goal}
        self._ask("send_goal", request, partial(self._accepted, key, listener))

    def put_cancel(self, key: bytes, answered: Callable[[int], None]) -> None:
        """Ask to cancel a goal."""
        request = {"goal_info": {"goal_id": {"uuid": list(key)}}}
        self._ask("cancel_goal", request, lambda response: answered(int(response.return_code)))

    def _accepted(self, key: bytes, listener: GoalListener, response: Any) -> None:
        listener.answered(bool(response.accepted))
        if response.accepted:
            self._listeners[key] = listener
            self._ask("get_result", {"goal_id": {"uuid": list(key)}}, partial(self._ended, key, listener))

    def _ended(self, key: bytes, listener: GoalListener, response: Any) -> None:
        self._listeners.pop(key, None)
        listener.ended(int(response.status), response.result)

    def _hear(self, message: Any, expires: float = inf) -> None:
        listener = self._listeners.get(bytes(message.goal_id.uuid))
        if listener is not None:
            listener.heard(message.feedback)

    def _ask(self, service: str, request: Any, answered: Callable[[Any], None]) -> None:
        caller = self._callers[service]
        self._graph.ask(caller.name, caller.type, make(f"{caller.type}_Request", request), answered)
