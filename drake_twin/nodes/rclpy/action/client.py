"""Stand-in for ``rclpy.action.client``."""

from collections.abc import Callable
from functools import partial
from operator import attrgetter
from types import SimpleNamespace
from typing import Any

from drake_twin.nodes import message_classes
from drake_twin.nodes.action_graph import ABORTED, CANCELED, CANCELING, NO_ERROR, SUCCEEDED, UNKNOWN
from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.action.graph import action_full_name
from drake_twin.nodes.rclpy.handle import Handle
from drake_twin.nodes.rclpy.task import Future
from drake_twin.nodes.rclpy.type_support import check_is_valid_action_type
from drake_twin.nodes.rclpy.waitable import GraphWaitable, NumberOfEntities
from drake_twin.nodes.simulated_time import wait_until
from drake_twin.nodes.task import present_task

_ENDED = (SUCCEEDED, CANCELED, ABORTED)


def __getattr__(name: str) -> Any:
    if name == "GoalStatus":  # nodes import it from here, too
        return message_class("action_msgs/msg/GoalStatus")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


class ClientGoalHandle:
    """A goal that a server has answered."""

    def __init__(self, action_client: "ActionClient", goal_id: Any, goal_response: Any):
        self._action_client, self._goal_id, self._goal_response = action_client, goal_id, goal_response
        self._status = UNKNOWN

    goal_id, status = property(attrgetter("_goal_id")), property(attrgetter("_status"))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ClientGoalHandle) and bool(self.goal_id == other.goal_id)

    def __hash__(self) -> int:
        return id(self)

    @property
    def stamp(self) -> Any:
        return self._goal_response.stamp

    @property
    def accepted(self) -> bool:
        return bool(self._goal_response.accepted)

    def cancel_goal(self) -> Any:
        return self._action_client._waited(self.cancel_goal_async())

    def cancel_goal_async(self) -> Future:
        return self._action_client._cancel_goal_async(self)

    def get_result(self) -> Any:
        return self._action_client._waited(self.get_result_async())

    def get_result_async(self) -> Future:
        """Return a future of the result, which is done as soon as the server has sent it."""
        return self._action_client._get_result_async(self)


class _Goal:
    """A goal on its way; the graph tells it what becomes of the goal."""

    def __init__(self, client: "ActionClient", goal_id: Any, feedback: Callable[[Any], Any] | None):
        self._client, self._goal_id, self._feedback = client, goal_id, feedback
        self.accepted_future, self.result_future = Future(), Future()
        self._handle: ClientGoalHandle | None = None

    def answered(self, is_accepted: bool, stamp: Any = None) -> None:
        self._client._post(partial(self._answered, is_accepted, stamp))

    def heard(self, feedback: Any) -> None:
        if self._feedback is not None:
            self._client._post(partial(self._heard, feedback))

    def moved(self, status: int) -> None:
        self._client._post(partial(self._moved, status))

    def ended(self, status: int, result: Any) -> None:
        self._client._post(partial(self._ended, status, result))

    def _answered(self, is_accepted: bool, stamp: Any) -> None:
        if stamp is None:
            stamp = self._client._node.get_clock().now().to_msg()
        else:
            stamp = message_classes.from_wire("builtin_interfaces/msg/Time", stamp)
        response = SimpleNamespace(accepted=is_accepted, stamp=stamp)
        self._handle = ClientGoalHandle(self._client, self._goal_id, response)
        self.accepted_future.set_result(self._handle)

    def _heard(self, feedback: Any) -> Any:
        assert self._feedback is not None
        name = f"{self._client._type}_Feedback"
        kind = self._client._action_type.Impl.FeedbackMessage
        return self._feedback(kind(goal_id=self._goal_id, feedback=message_classes.from_wire(name, feedback)))

    def _moved(self, status: int) -> None:
        if self._handle is not None and self._handle.status not in _ENDED:
            self._handle._status = status

    def _ended(self, status: int, result: Any) -> None:
        self._moved(status)
        empty = self._client._action_type.Result
        message = empty() if result is None else message_classes.from_wire(f"{self._client._type}_Result", result)
        kind = self._client._action_type.Impl.GetResultService.Response
        self.result_future.set_result(kind(status=status, result=message))


class ActionClient(GraphWaitable):
    """Sends goals to an action."""

    def __init__(
        self,
        node: Any,
        action_type: Any,
        action_name: str,
        *,
        callback_group: Any = None,
        goal_service_qos_profile: Any = None,
        result_service_qos_profile: Any = None,
        cancel_service_qos_profile: Any = None,
        feedback_sub_qos_profile: Any = None,
        status_sub_qos_profile: Any = None,
    ):
        check_is_valid_action_type(action_type)
        super().__init__(callback_group or node.default_callback_group)
        self._node, self._action_type, self._action_name = node, action_type, action_name
        self._client_handle = Handle(self._end, action_full_name(node, action_name, "client"))
        self._type = message_classes.type_name(action_type)
        self._actions = node.handle.actions
        self._goals: dict[bytes, _Goal] = {}
        self._outside = self._actions.call(self._client_handle.name, self._type, node.handle.name)
        present_task().program.belongings.append(self._outside)
        node.add_waitable(self)

    def send_goal(self, goal: Any, **kwargs: Any) -> Any:
        """Send a goal, and wait for its result while another thread spins."""
        return self._waited(self._waited(self.send_goal_async(goal, **kwargs)).get_result_async())

    def send_goal_async(
        self, goal: Any, feedback_callback: Callable[[Any], Any] | None = None, goal_uuid: Any = None
    ) -> Future:
        task = present_task()
        if not isinstance(goal, self._action_type.Goal):
            raise TypeError(f"Expected {self._action_type.Goal}, got {type(goal)}")
        self._client_handle.check()
        goal_id = goal_uuid or new_goal_id(task.program.rclpy, task.program.index)
        key = bytes(goal_id.uuid)
        sent = self._goals[key] = _Goal(self, goal_id, feedback_callback)
        self._actions.send(self._outside, key, message_classes.to_wire(goal), sent)
        return sent.accepted_future

    def _cancel_goal_async(self, goal_handle: ClientGoalHandle) -> Future:
        future, key = Future(), bytes(goal_handle.goal_id.uuid)

        def finish(response: Any) -> None:
            if response.return_code == NO_ERROR and goal_handle.status not in _ENDED and response.goals_canceling:
                goal_handle._status = CANCELING
            future.set_result(message_classes.from_wire("action_msgs/srv/CancelGoal_Response", response))

        self._actions.cancel(self._outside, key, lambda response: self._post(partial(finish, response)))
        return future

    def _get_result_async(self, goal_handle: ClientGoalHandle) -> Future:
        future, key = Future(), bytes(goal_handle.goal_id.uuid)
        if self._actions.is_twins(self._outside):  # which tells of the result at the goal's end
            sent = self._goals[key]
            if not goal_handle.accepted:
                sent.ended(UNKNOWN, None)
            sent.result_future.add_done_callback(lambda done: future.set_result(done.result()))
            return future

        def finish(response: Any) -> None:
            future.set_result(message_classes.from_wire(f"{self._type}_GetResult_Response", response))

        self._outside.put_result(key, lambda response: self._post(partial(finish, response)))
        return future

    def _waited(self, future: Future) -> Any:
        """Wait for a future while another thread spins; return its result."""
        wait_until(present_task(), lambda: future._done, None)
        return future.result()

    def server_is_ready(self) -> bool:
        present_task().count_idle_call()
        self._client_handle.check()
        return bool(self._actions.is_there(self._outside))

    def wait_for_server(self, timeout_sec: float | None = None) -> bool:
        ready = partial(self._actions.is_there, self._outside)
        wait_until(present_task(), lambda: ready() or not self._node.context.is_valid, timeout_sec)
        return bool(ready())

    def get_num_entities(self) -> NumberOfEntities:
        return NumberOfEntities(num_subs=2, num_clients=3)

    def destroy(self) -> None:
        self._client_handle.destroy_when_not_in_use()

    def _end(self) -> None:
        self._node.remove_waitable(self)
        self._actions.withdraw(self._outside)


def new_goal_id(known: dict[str, Any], index: int) -> Any:
    """Return an id that no other goal has; it is the same in every run."""
    uuid = message_class("unique_identifier_msgs/msg/UUID")

    count = known["goals"] = known.get("goals", 0) + 1
    return uuid(uuid=list(index.to_bytes(8, "big") + count.to_bytes(8, "big")))
