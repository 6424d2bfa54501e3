"""What an action server is on the graph: three services and two topics."""

from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any

from drake_twin.nodes import message_classes
from drake_twin.nodes.graph_items import Offer
from drake_twin.nodes.rclpy.handle import Handle
from drake_twin.nodes.rclpy.node_handle import NodeHandle
from drake_twin.nodes.rclpy.publisher import PublisherHandle
from drake_twin.nodes.task import present_task

GOAL, CANCEL, RESULT = "send_goal", "cancel_goal", "get_result"


class ServerHandle(Handle):
    """An action on the graph.

    Args:
        node: Its node.
        action_type: The class of the action.
        name: Its full name.
        feedback: The quality of service of its feedback.
        status: The quality of service of its statuses.

    Attributes:
        type: Its ROS type.
        node: The full name of its node.
        feedback: Publishes feedback.
        status: Publishes the statuses.
        requests: Service → the requests that wait, each with the function that takes its response.
    """

    def __init__(self, node: NodeHandle, action_type: Any, name: str, feedback: Any, status: Any):
        super().__init__(self._withdraw, name, node.logger_name)
        self._graph, self._actions = node.graph, node.actions
        self.type, self.node = message_classes.type_name(action_type), node.name
        kinds = {
            GOAL: action_type.Impl.SendGoalService,
            CANCEL: action_type.Impl.CancelGoalService,
            RESULT: action_type.Impl.GetResultService,
        }
        self.requests: dict[str, deque[tuple[Any, Callable[[Any], None]]]] = {part: deque() for part in kinds}
        self._offers = [
            Offer(f"{name}/_action/{part}", message_classes.type_name(kind), node.name, partial(self._put, part))
            for part, kind in kinds.items()
        ]
        self.feedback = PublisherHandle(node, action_type.Impl.FeedbackMessage, f"{name}/_action/feedback", feedback)
        self.status = PublisherHandle(node, action_type.Impl.GoalStatusMessage, f"{name}/_action/status", status)
        for offer in self._offers:
            node.graph.offer(offer)
        present_task().program.belongings += [*self._offers, self]
        self.feedback.advertise()
        self.status.advertise()
        node.actions.offer(self)

    def _put(self, part: str, request: Any, reply: Callable[[Any], None]) -> None:
        self.requests[part].append((request, reply))

    def take(self, part: str) -> tuple[Any, Callable[[Any], None]] | None:
        """Return the next request to a service, with the function that takes its response; None without one."""
        waiting = self.requests[part]
        if not waiting:
            return None
        offer = next(item for item in self._offers if item.name.endswith(part))
        request, reply = waiting.popleft()
        given = message_classes.from_wire(f"{offer.type}_Request", request)
        return given, lambda response: reply(message_classes.to_wire(response))

    def _withdraw(self) -> None:
        self._actions.withdraw(self)
        for offer in self._offers:
            self._graph.withdraw(offer)
        self.feedback.destroy_when_not_in_use()
        self.status.destroy_when_not_in_use()
