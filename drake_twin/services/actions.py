"""Actions as ROS 2 has them on the graph: three services, feedback and a status for each action."""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from itertools import islice
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.errors import TwinError
from drake_twin.messages import time_message
from drake_twin.services.registry import SIMULATION_NODE, Fields, Later, Service
from drake_twin.services.running import StepsGoal, refused
from drake_twin.twin.endpoints import PUBLISHED, Endpoint
from drake_twin.twin.twin import Twin

# action_msgs/msg/GoalStatus
_UNKNOWN = 0
STATUSES = {"accepted": 1, "executing": 2, "canceling": 3, "succeeded": 4, "canceled": 5, "aborted": 6}
_ACCEPTED_CANCEL, _REJECTED_CANCEL, _UNKNOWN_GOAL, _ENDED_GOAL = range(4)  # action_msgs/srv/CancelGoal
_MOST_ENDED = 50  # goals whose results are kept
_FEEDBACK_PERIOD = 0.05  # s of simulation time; action_monitor_rate is 20 Hz by default
_ALL_GOALS = bytes(16)


@dataclass(frozen=True)
class KnownGoal:
    """A goal that has been accepted.

    Attributes:
        goal: The goal, with the properties of `drake_twin.twin.action.ActionGoal` and ``cancel``; its status may also
            be ``canceling``.
        stamp: The time at which it was accepted, as a message.
    """

    goal: Any
    stamp: Any


class ActionServer:
    """An action of the twin.

    Args:
        name: The action's full name.
        type: Its ROS type.
        node: The full name of its node.
        start: Starts a goal; raises a `TwinError` if it is rejected.
        time: Returns the simulation time (s).
        proceed: Continues a running goal, between two advances.

    Attributes:
        feedback_topic: The topic of the feedback.
        status_topic: The topic of the goals' statuses.
    """

    def __init__(
        self,
        name: str,
        type: str,
        node: str,
        start: Callable[[Any], Any],
        time: Callable[[], float],
        proceed: Callable[[Any], None] = lambda goal: None,
    ):
        self.name, self.node = name, node
        self.feedback_topic = Endpoint(PUBLISHED, f"{name}/_action/feedback", f"{type}_FeedbackMessage", node)
        self.status_topic = Endpoint(
            PUBLISHED, f"{name}/_action/status", "action_msgs/msg/GoalStatusArray", node, latched=True
        )
        self._type, self._start, self._time, self._proceed = type, start, time, proceed
        self._goals: dict[bytes, KnownGoal] = {}
        self._told: dict[bytes, int] = {}
        self._next_feedback = 0.0

    def services(self) -> Iterator[Service]:
        """Yield the action's services."""
        for name, kind, answer in (
            ("send_goal", f"{self._type}_SendGoal", self._send_goal),
            ("cancel_goal", "action_msgs/srv/CancelGoal", self._cancel_goal),
            ("get_result", f"{self._type}_GetResult", self._get_result),
        ):
            yield Service(f"{self.name}/_action/{name}", kind, self.node, answer)

    def proceed(self) -> None:
        """Continue the running goals, between two advances."""
        for known in self._goals.values():
            self._proceed(known.goal)

    def news(self) -> Iterator[tuple[str, Fields]]:
        """Yield the messages that are due: the statuses when they have changed, and feedback at 20 Hz."""
        if not self._goals:
            return
        statuses = {key: STATUSES[known.goal.status] for key, known in self._goals.items()}
        if statuses != self._told:
            self._told = statuses
            told = [{"goal_info": _info(key, self._goals[key]), "status": status} for key, status in statuses.items()]
            yield self.status_topic.name, {"status_list": told}
        now = self._time()
        if not self._next_feedback - _FEEDBACK_PERIOD <= now < self._next_feedback:  # it is earlier after a reset
            self._next_feedback = now + _FEEDBACK_PERIOD
            for key, known in self._goals.items():
                if not known.goal.is_done and (feedback := known.goal.feedback) is not None:
                    yield self.feedback_topic.name, {"goal_id": _uuid(key), "feedback": feedback}

    def _send_goal(self, request: Any) -> Fields | Later:
        key, stamp = bytes(request.goal_id.uuid), time_message(self._time())
        if key in self._goals:
            return {**refused(self.name, "a goal of this id is known already", "accepted"), "stamp": stamp}
        try:
            self._keep(key, KnownGoal(self._start(request.goal), stamp))
        except TwinError as error:
            return {**refused(self.name, error, "accepted"), "stamp": stamp}
        return {"accepted": True, "stamp": stamp}

    def _keep(self, key: bytes, known: KnownGoal) -> None:
        """Keep a goal, and forget those that ended long ago."""
        self._goals[key] = known
        ended = [key for key, known in self._goals.items() if known.goal.is_done]
        for old in islice(ended, max(0, len(ended) - _MOST_ENDED)):
            del self._goals[old]

    def _get_result(self, request: Any) -> Later:
        known = self._goals.get(bytes(request.goal_id.uuid))
        if known is None:
            return {"status": _UNKNOWN}
        while not known.goal.is_done:
            yield
        result = known.goal.result
        return {"status": STATUSES[known.goal.status], **({} if result is None else {"result": result})}

    def _cancel_goal(self, request: Any) -> Fields | Later:
        code, running = self._to_cancel(request)
        for known in running.values():
            known.goal.cancel()
        return canceling(code, running)

    def _to_cancel(self, request: Any) -> tuple[int, dict[bytes, KnownGoal]]:
        """Return the code of the answer, and the goals to cancel.

        It is one goal, or with its zero those accepted until a time, or with both zero all.
        """
        wanted, until = bytes(request.goal_info.goal_id.uuid), _nanoseconds(request.goal_info.stamp)
        if wanted != _ALL_GOALS and wanted not in self._goals and not until:
            return _UNKNOWN_GOAL, {}
        chosen = {
            key: known
            for key, known in self._goals.items()
            if key == wanted or (until and _nanoseconds(known.stamp) <= until) or (wanted == _ALL_GOALS and not until)
        }
        running = {key: known for key, known in chosen.items() if not known.goal.is_done}
        if wanted in chosen and not running:
            return _ENDED_GOAL, {}
        return _ACCEPTED_CANCEL if running or wanted == _ALL_GOALS else _REJECTED_CANCEL, running


def action_servers(twin: Twin) -> Iterator[ActionServer]:
    """Yield the actions of a twin: its robots' controllers', and ``simulate_steps``."""

    def time() -> float:
        return twin.time

    for action, kind in twin.graph.actions().items():
        yield ActionServer(action, kind, action.rpartition("/")[0], partial(twin.graph.send_goal, action), time)
    steps = f"{SIMULATION_NODE}/simulate_steps"
    kind = "simulation_interfaces/action/SimulateSteps"
    yield ActionServer(steps, kind, SIMULATION_NODE, lambda goal: StepsGoal(twin, goal.steps), time, StepsGoal.proceed)


def canceling(code: int, goals: Mapping[bytes, KnownGoal]) -> Fields:
    """Return the response to the wish to cancel goals."""
    infos = [_info(key, known) for key, known in goals.items()]
    return {"return_code": code, **({"goals_canceling": infos} if infos else {})}


def _uuid(key: bytes) -> Fields:
    return {"uuid": list(key)}


def _info(key: bytes, known: KnownGoal) -> Fields:
    return {"goal_id": _uuid(key), "stamp": known.stamp}


def _nanoseconds(stamp: Any) -> int:
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
