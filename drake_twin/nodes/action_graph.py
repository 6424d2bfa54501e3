"""The actions that node programs share with each other and with the twin."""

from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any, Protocol

from drake_twin.errors import TwinError
from drake_twin.messages.interface_types import make
from drake_twin.nodes.graph import Graph
from drake_twin.nodes.graph_items import GoalListener
from drake_twin.nodes.outside_action import OutsideAction
from drake_twin.nodes.program import Program
from drake_twin.twin.action import ActionGoal

# action_msgs/msg/GoalStatus
UNKNOWN, ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(7)
_STATUSES = {
    "accepted": ACCEPTED,
    "executing": EXECUTING,
    "succeeded": SUCCEEDED,
    "canceled": CANCELED,
    "aborted": ABORTED,
}
NO_ERROR, REJECTED, UNKNOWN_GOAL, ENDED_GOAL = range(4)  # action_msgs/srv/CancelGoal
_MOST_ENDED = 50  # goals that are known to have ended
_FEEDBACK_PERIOD = 50_000_000  # ns; action_monitor_rate is 20 Hz by default


class ActionOffer(Protocol):
    """An action that a node offers.

    Attributes:
        name: Its full name.
        type: Its ROS type.
        node: The full name of the node.
    """

    name: str
    type: str
    node: str


class ActionGraph:
    """The actions.

    Args:
        graph: The topics and services beside them.
    """

    def __init__(self, graph: Graph):
        self._graph = graph
        self.offers: dict[str, ActionOffer] = {}
        self._goals: dict[bytes, tuple[ActionGoal, GoalListener]] = {}
        self._ended: deque[bytes] = deque(maxlen=_MOST_ENDED)
        self._outside: dict[str, list[OutsideAction]] = {}

    def post(self, act: Callable[[], None]) -> None:
        """Let something happen in a later slot."""
        self._graph.post(act)

    def offer(self, offer: ActionOffer) -> None:
        """Add an action that a node offers."""
        self.offers[offer.name] = offer
        self._graph.note_change()

    def withdraw(self, offer: ActionOffer | OutsideAction) -> None:
        """Take back an action that a node offers, or one that it looks for."""
        if isinstance(offer, OutsideAction):
            if offer in self._outside.get(offer.name, ()):
                self._outside[offer.name].remove(offer)
                offer.close()
        elif self.offers.get(offer.name) is offer:
            del self.offers[offer.name]
            self._graph.note_change()

    def forget(self, program: Program) -> None:
        """Take back all that a program has."""
        offers = list(self.offers.values())
        for item in program.belongings:
            if isinstance(item, OutsideAction) or any(item is offer for offer in offers):
                self.withdraw(item)

    def call(self, name: str, kind: str, node: str) -> OutsideAction:
        """Look for an action that another program may offer, until `withdraw`."""
        action = OutsideAction(self._graph, name, kind, node)
        self._outside.setdefault(name, []).append(action)
        return action

    def is_twins(self, action: OutsideAction) -> bool:
        """Return whether the twin itself offers an action."""
        return bool(self._graph.twin.graph.actions().get(action.name) == action.type)

    def is_there(self, action: OutsideAction) -> bool:
        """Return whether an action is there."""
        return self.is_twins(action) or action.is_there

    def names(self) -> list[tuple[str, list[str]]]:
        """Return each action with its types."""
        found = {name: [kind] for name, kind in self._graph.twin.graph.actions().items()}
        for name, offer in self.offers.items():
            found.setdefault(name, []).append(offer.type)
        return sorted(found.items())

    def names_of_servers(self, node: str) -> list[tuple[str, list[str]]]:
        """Return the actions that a node offers, with their types."""
        return sorted((name, [offer.type]) for name, offer in self.offers.items() if offer.node == node)

    def names_of_clients(self, node: str) -> list[tuple[str, list[str]]]:
        """Return the actions that a node asks for, with their types."""
        found = {item.name: [item.type] for items in self._outside.values() for item in items if item.node == node}
        return sorted(found.items())

    def send(self, action: OutsideAction, key: bytes, goal: Any, listener: GoalListener) -> None:
        """Send a goal; an action that is not there does not answer."""
        if self.is_twins(action):
            self._graph.post(partial(self._start, action.name, key, goal, listener))
        elif action.is_there:
            action.put_goal(key, goal, listener)

    def cancel(self, action: OutsideAction, key: bytes, answered: Callable[[Any], None]) -> None:
        """Cancel a goal; the answer is that of ``action_msgs/srv/CancelGoal``."""
        if self.is_twins(action):
            self._graph.post(partial(self._cancel, key, answered))
        else:
            action.put_cancel(key, answered)

    def _start(self, name: str, key: bytes, goal: Any, listener: GoalListener) -> None:
        def ended(done: ActionGoal) -> None:
            self._forget(key)
            self._graph.post(partial(listener.ended, _STATUSES[done.status], done.result))

        try:
            started = self._graph.twin.graph.send_goal(name, goal, ended)
        except TwinError as error:
            self._graph.log(name, str(error))
            self._graph.post(partial(listener.answered, False))
            return
        self._goals[key] = started, listener
        self._graph.post(partial(listener.answered, True))
        self._graph.post(partial(self._feed_back, key), _FEEDBACK_PERIOD)

    def _feed_back(self, key: bytes) -> None:
        known = self._goals.get(key)
        if known is None:
            return
        goal, listener = known
        if goal.is_done:  # it was dropped by a reset, which calls nobody back
            self._forget(key)
            listener.ended(_STATUSES[goal.status], goal.result)
            return
        if (feedback := goal.feedback) is not None:
            listener.heard(feedback)
        self._graph.post(partial(self._feed_back, key), _FEEDBACK_PERIOD)

    def _forget(self, key: bytes) -> None:
        self._goals.pop(key, None)
        self._ended.append(key)

    def _cancel(self, key: bytes, answered: Callable[[Any], None]) -> None:
        known = self._goals.get(key)
        fields: dict[str, Any] = {"return_code": ENDED_GOAL if key in self._ended else UNKNOWN_GOAL}
        if known is not None:
            known[0].cancel()
            fields = {"return_code": NO_ERROR, "goals_canceling": [{"goal_id": {"uuid": list(key)}}]}
        self._graph.post(partial(answered, make("action_msgs/srv/CancelGoal_Response", fields)))
