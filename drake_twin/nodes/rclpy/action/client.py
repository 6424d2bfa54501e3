"""Stand-in for ``rclpy.action.client``."""

from collections.abc import Callable
from functools import partial
from operator import attrgetter
from types import SimpleNamespace
from typing import Any

from drake_twin.nodes import message_classes
from drake_twin.nodes.action_graph import ACCEPTED, CANCELING, NO_ERROR, UNKNOWN
from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.action.graph import action_full_name
from drake_twin.nodes.rclpy.handle import Handle
from drake_twin.nodes.rclpy.task import Future
from drake_twin.nodes.rclpy.type_support import check_is_valid_action_type
from drake_twin.nodes.rclpy.waitable import GraphWaitable
from drake_twin.nodes.simulated_time import wait_until
from drake_twin.nodes.task import present_task


def __getattr__(name: str) -> Any:
    if name == "GoalStatus":  # nodes import it from here, too
        return message_class("action_msgs/msg/GoalStatus")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


class ClientGoalHandle:
    """A goal that a server has answered."""

    def __init__(self, action_client: "ActionClient", goal_id: Any, goal_response: Any, future: Future):
        self._action_client, self._goal_id, self._goal_response = action_client, goal_id, goal_response
        self._status = ACCEPTED if goal_response.accepted else UNKNOWN
        self._future = future

    goal_id, status = property(attrgetter("_goal_id")), property(attrgetter("_status"))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ClientGoalHandle) and self.goal_id == other.goal_id

    def __hash__(self) -> int:
        return id(self)

    @property
    def stamp(self) -> Any:
        return self._goal_response.stamp

    @property
    def accepted(self) -> bool:
        return bool(self._goal_response.accepted)

    def cancel_goal(self) -> Any:
        return self._action_client.waited(self.cancel_goal_async())

    def cancel_goal_async(self) -> Future:
        return self._action_client.cancel(self)

    def get_result(self) -> Any:
        return self._action_client.waited(self.get_result_async())

    def get_result_async(self) -> Future:
        """Return a future of the result, which is done as soon as the server has sent it."""
        future = Future()
        self._future.add_done_callback(lambda done: future.set_result(done.result()))
        return future


class _Goal:
    """A goal on its way; the graph tells it what becomes of the goal."""

    def __init__(self, client: "ActionClient", goal_id: Any, feedback: Callable[[Any], Any] | None):
        self._client, self._goal_id, self._feedback = client, goal_id, feedback
        self.accepted_future, self.result_future = Future(), Future()
        self.handle: ClientGoalHandle | None = None

    def answered(self, is_accepted: bool) -> None:
        self._client.put(partial(self._answered, is_accepted))

    def heard(self, feedback: Any) -> None:
        if self._feedback is not None:
            self._client.put(partial(self._heard, feedback))

    def ended(self, status: int, result: Any) -> None:
        self._client.put(partial(self._ended, status, result))

    def _answered(self, is_accepted: bool) -> None:
        stamp = self._client.node.get_clock().now().to_msg()
        response = SimpleNamespace(accepted=is_accepted, stamp=stamp)
        self.handle = ClientGoalHandle(self._client, self._goal_id, response, self.result_future)
        self.accepted_future.set_result(self.handle)

    def _heard(self, feedback: Any) -> Any:
        assert self._feedback is not None
        name = f"{self._client.type}_Feedback"
        kind = self._client._action_type.Impl.FeedbackMessage
        return self._feedback(kind(goal_id=self._goal_id, feedback=message_classes.from_wire(name, feedback)))

    def _ended(self, status: int, result: Any) -> None:
        empty = self._client._action_type.Result
        message = empty() if result is None else message_classes.from_wire(f"{self._client.type}_Result", result)
        if self.handle is not None:
            self.handle._status = status
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
        self.node, self._action_type = node, action_type
        self.name = action_full_name(node, action_name, "client")
        self._handle = Handle(self._end, self.name)
        self.type = message_classes.type_name(action_type)
        self._actions = node._twin_actions
        self._count = 0
        self._outside = self._actions.call(self.name, self.type, node.get_fully_qualified_name())
        present_task().program.belongings.append(self._outside)
        node.add_waitable(self)

    def send_goal(self, goal: Any, **kwargs: Any) -> Any:
        """Send a goal, and wait for its result while another thread spins."""
        if not isinstance(goal, self._action_type.Goal):
            raise TypeError(f"Expected {self._action_type.Goal}, got {type(goal)}")
        handle = self.waited(self.send_goal_async(goal, **kwargs))
        return self.waited(handle.get_result_async()) if handle.accepted else None

    def send_goal_async(
        self, goal: Any, feedback_callback: Callable[[Any], Any] | None = None, goal_uuid: Any = None
    ) -> Future:
        task = present_task()
        if not isinstance(goal, self._action_type.Goal):
            raise TypeError(f"Expected {self._action_type.Goal}, got {type(goal)}")
        self._handle.check()
        goal_id = goal_uuid or new_goal_id(task.program.rclpy, task.program.index)
        sent = _Goal(self, goal_id, feedback_callback)
        self._actions.send(self.name, self.type, bytes(goal_id.uuid), message_classes.to_wire(goal), sent)
        return sent.accepted_future

    def cancel(self, handle: ClientGoalHandle) -> Future:
        """Cancel a goal; return the future of a ``CancelGoal`` response."""
        future = Future()

        def answered(code: int) -> None:
            self.put(lambda: future.set_result(_cancel_response(code, handle)))

        self._actions.cancel(self.name, bytes(handle.goal_id.uuid), answered)
        return future

    def waited(self, future: Future) -> Any:
        """Wait for a future while another thread spins; return its result."""
        wait_until(present_task(), lambda: future.has_ended, None)
        return future.result()

    def server_is_ready(self) -> bool:
        present_task().count_idle_call()
        self._handle.check()
        return bool(self._actions.is_there(self.name, self.type))

    def wait_for_server(self, timeout_sec: float | None = None) -> bool:
        ready = partial(self._actions.is_there, self.name, self.type)
        wait_until(present_task(), lambda: ready() or not self.node.context.is_valid, timeout_sec)
        return bool(ready())

    def destroy(self) -> None:
        self._handle.destroy_when_not_in_use()

    def _end(self) -> None:
        self.node.remove_waitable(self)
        self._actions.withdraw(self._outside)


def new_goal_id(known: dict[str, Any], index: int) -> Any:
    """Return an id that no other goal has; it is the same in every run."""
    uuid = message_class("unique_identifier_msgs/msg/UUID")

    count = known["goals"] = known.get("goals", 0) + 1
    return uuid(uuid=list(index.to_bytes(8, "big") + count.to_bytes(8, "big")))


def _cancel_response(code: int, handle: ClientGoalHandle) -> Any:
    goal_info = message_class("action_msgs/msg/GoalInfo")
    response = message_class("action_msgs/srv/CancelGoal_Response")

    if code == NO_ERROR:
        handle._status = CANCELING
    goals = [goal_info(goal_id=handle.goal_id, stamp=handle.stamp)] if code == NO_ERROR else []
    return response(return_code=code, goals_canceling=goals)
