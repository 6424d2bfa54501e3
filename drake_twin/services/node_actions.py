"""The actions of node programs as ROS 2 has them on the graph."""

from collections import deque
from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

from drake_twin.errors import TwinError
from drake_twin.messages import time_message
from drake_twin.services.actions import STATUSES, ActionServer, KnownGoal, canceling
from drake_twin.services.registry import Fields, Later
from drake_twin.services.running import refused

if TYPE_CHECKING:
    from drake_twin.nodes.action_graph import ActionGraph, ActionOffer

_NAMES = {number: name for name, number in STATUSES.items()}
_REJECTED_CANCEL = 1


class NodeGoal:
    """A goal that a wire has sent to a node program.

    Args:
        status: Returns the goal's status at its server; zero if that does not know it.

    Attributes:
        is_accepted: Whether it has been accepted; None before the answer.
        result: The result; None before the goal ends.
        feedbacks: The feedback that is not passed on yet.
    """

    def __init__(self, status: Callable[[], int]):
        self.is_accepted: bool | None = None
        self.result: Any = None
        self.feedbacks: deque[Any] = deque()
        self._status, self._end = status, 0

    @property
    def status(self) -> str:
        """Its status, as `drake_twin.services.actions.STATUSES` has it."""
        return _NAMES[self._end or self._status() or STATUSES["aborted"]]

    @property
    def is_done(self) -> bool:
        """Whether it has ended, or its server has."""
        return bool(self._end or not self._status())

    @property
    def feedback(self) -> None:
        """Nothing: each feedback is passed on once."""

    def cancel(self) -> None:
        """Do nothing: the server asks the program."""

    def answered(self, is_accepted: bool) -> None:
        """Take note of whether the goal has been accepted."""
        self.is_accepted = is_accepted

    def heard(self, feedback: Any) -> None:
        """Take note of feedback."""
        self.feedbacks.append(feedback)

    def ended(self, status: int, result: Any) -> None:
        """Take note of the goal's end."""
        self._end, self.result = status, result


class NodeActionServer(ActionServer):
    """An action of a node program; it shows the goals that come through it.

    Args:
        offer: The action.
        actions: The actions of all programs.
        time: Returns the simulation time (s).
    """

    def __init__(self, offer: "ActionOffer", actions: "ActionGraph", time: Callable[[], float]):
        super().__init__(offer.name, offer.type, offer.node, lambda goal: None, time)
        self.offer = offer
        self._actions = actions

    def news(self) -> Iterator[tuple[str, Fields]]:
        """Yield the messages that are due: all feedback, and the statuses when they have changed."""
        for key, known in self._goals.items():
            while known.goal.feedbacks:
                feedback = known.goal.feedbacks.popleft()
                yield self.feedback_topic.name, {"goal_id": {"uuid": list(key)}, "feedback": feedback}
        yield from super().news()

    def _send_goal(self, request: Any) -> Later:
        key = bytes(request.goal_id.uuid)
        goal = NodeGoal(partial(self._status_of, key))
        self._actions.post(partial(self.offer.put_goal, key, request.goal, goal))
        while goal.is_accepted is None:
            self._check()
            yield
        stamp = time_message(self._time())
        if not goal.is_accepted:
            return {**refused(self.name, "the node rejects the goal", "accepted"), "stamp": stamp}
        self._keep(key, KnownGoal(goal, stamp))
        return {"accepted": True, "stamp": stamp}

    def _cancel_goal(self, request: Any) -> Later:
        code, running = self._to_cancel(request)
        codes: dict[bytes, int] = {}
        for key in running:
            self._actions.post(partial(self.offer.put_cancel, key, partial(codes.__setitem__, key)))
        while len(codes) < len(running):
            self._check()
            yield
        accepted = {key: known for key, known in running.items() if not codes[key]}
        return canceling(_REJECTED_CANCEL if running and not accepted else code, accepted)

    @property
    def _is_there(self) -> bool:
        return self._actions.offers.get(self.name) is self.offer

    def _status_of(self, key: bytes) -> int:
        return self.offer.status_of(key) if self._is_there else 0

    def _check(self) -> None:
        if not self._is_there:
            raise TwinError(f"{self.name}: its node has ended")
