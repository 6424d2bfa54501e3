"""Stand-in for ``rclpy.action.server``."""

import inspect
import traceback
from collections import deque
from collections.abc import Callable
from enum import Enum
from operator import attrgetter
from typing import Any

from drake_twin.nodes.action_graph import (
    ABORTED,
    ACCEPTED,
    CANCELED,
    CANCELING,
    ENDED_GOAL,
    EXECUTING,
    SUCCEEDED,
    UNKNOWN,
    UNKNOWN_GOAL,
)
from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy._rclpy_pybind11 import RCLError
from drake_twin.nodes.rclpy.action.graph import action_full_name
from drake_twin.nodes.rclpy.action.server_handle import CANCEL, GOAL, RESULT, ServerHandle
from drake_twin.nodes.rclpy.native import native_enum
from drake_twin.nodes.rclpy.qos_profiles import QoSProfile, qos_profile_action_status_default
from drake_twin.nodes.rclpy.task import Future
from drake_twin.nodes.rclpy.time import Time
from drake_twin.nodes.rclpy.type_support import check_is_valid_action_type
from drake_twin.nodes.rclpy.waitable import NumberOfEntities, Waitable
from drake_twin.nodes.task import present_task

GoalEvent = native_enum(
    "GoalEvent", "What happens to a goal.", __name__, EXECUTE=0, CANCEL_GOAL=1, SUCCEED=2, ABORT=3, CANCELED=4
)
# Event → the states in which rcl accepts it, and the next state (rcl_action/src/rcl_action/goal_state_machine.c).
_EVENTS = {
    GoalEvent.EXECUTE: ((ACCEPTED,), EXECUTING),
    GoalEvent.CANCEL_GOAL: ((ACCEPTED, EXECUTING), CANCELING),
    GoalEvent.SUCCEED: ((EXECUTING, CANCELING), SUCCEEDED),
    GoalEvent.ABORT: ((EXECUTING, CANCELING), ABORTED),
    GoalEvent.CANCELED: ((CANCELING,), CANCELED),
}
_STATES = ["UNKNOWN", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED"]
_ACTIVE = (ACCEPTED, EXECUTING, CANCELING)


def __getattr__(name: str) -> Any:
    if name == "GoalStatus":  # nodes import it from here, too
        return message_class("action_msgs/msg/GoalStatus")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


class GoalResponse(Enum):
    """Whether a goal is accepted."""

    REJECT = 1
    ACCEPT = 2


class CancelResponse(Enum):
    """Whether a goal is canceled."""

    REJECT = 1
    ACCEPT = 2


class ServerGoalHandle:
    """A goal that a server has accepted."""

    def __init__(self, action_server: "ActionServer", goal_info: Any, goal_request: Any):
        self._action_server, self._goal_info, self._goal_request = action_server, goal_info, goal_request
        self._status = ACCEPTED

    request = property(attrgetter("_goal_request"))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ServerGoalHandle) and bool(self.goal_id == other.goal_id)

    __hash__ = None  # type: ignore[assignment]  # as in rclpy

    @property
    def goal_id(self) -> Any:
        return self._goal_info.goal_id

    @property
    def status(self) -> int:
        present_task()
        return self._status

    @property
    def is_active(self) -> bool:
        return self._status in _ACTIVE

    @property
    def is_cancel_requested(self) -> bool:
        return self.status == CANCELING

    def execute(self, execute_callback: Callable[[Any], Any] | None = None) -> None:
        if not self.is_cancel_requested:
            self._update_state(GoalEvent.EXECUTE)
        self._action_server.notify_execute(self, execute_callback)

    def publish_feedback(self, feedback: Any) -> None:
        present_task()
        kind = self._action_server.action_type
        if not isinstance(feedback, kind.Feedback):
            raise TypeError
        if self._status != UNKNOWN:
            message = kind.Impl.FeedbackMessage(goal_id=self.goal_id, feedback=feedback)
            self._action_server._handle.feedback.publish(message)

    def succeed(self) -> None:
        self._update_state(GoalEvent.SUCCEED)

    def abort(self) -> None:
        self._update_state(GoalEvent.ABORT)

    def canceled(self) -> None:
        self._update_state(GoalEvent.CANCELED)

    def destroy(self) -> None:
        self._status = UNKNOWN

    def _update_state(self, event: Any) -> None:
        if self._status == UNKNOWN:
            return
        accepted, state = _EVENTS[event]
        if self._status not in accepted:
            text = f"attempted invalid transition from state {_STATES[self._status]} with event {event.name}"
            raise RCLError(f"Failed to update goal state: goal_handle {text}")
        self._status = state
        self._action_server._publish_status()
        if not self.is_active:
            self._action_server._note_end(self)


def default_handle_accepted_callback(goal_handle: ServerGoalHandle) -> None:
    goal_handle.execute()


def default_goal_callback(goal_request: Any) -> GoalResponse:
    return GoalResponse.ACCEPT


def default_cancel_callback(cancel_request: Any) -> CancelResponse:
    return CancelResponse.REJECT


class ActionServer(Waitable):
    """Executes goals."""

    def __init__(
        self,
        node: Any,
        action_type: Any,
        action_name: str,
        execute_callback: Callable[[Any], Any],
        *,
        callback_group: Any = None,
        goal_callback: Callable[[Any], Any] = default_goal_callback,
        handle_accepted_callback: Callable[[Any], Any] = default_handle_accepted_callback,
        cancel_callback: Callable[[Any], Any] = default_cancel_callback,
        goal_service_qos_profile: Any = None,
        result_service_qos_profile: Any = None,
        cancel_service_qos_profile: Any = None,
        feedback_pub_qos_profile: QoSProfile | None = None,
        status_pub_qos_profile: QoSProfile = qos_profile_action_status_default,
        result_timeout: int = 900,
    ):
        super().__init__(callback_group or node.default_callback_group)
        self.register_handle_accepted_callback(handle_accepted_callback)
        self.register_goal_callback(goal_callback)
        self.register_cancel_callback(cancel_callback)
        self.register_execute_callback(execute_callback)
        check_is_valid_action_type(action_type)
        self._node, self._action_type = node, action_type
        full = action_full_name(node, action_name, "server")
        feedback = feedback_pub_qos_profile or QoSProfile(depth=10)
        self._handle = ServerHandle(node.handle, action_type, full, feedback, status_pub_qos_profile)
        self._goal_handles: dict[bytes, ServerGoalHandle] = {}
        self._result_futures: dict[bytes, Future] = {}
        self._result_timeout = round(result_timeout * 1e9)
        self._ends: deque[tuple[int, bytes]] = deque()  # the time (ns) at which a result is forgotten, and its goal
        self._task = present_task()
        node.add_waitable(self)
        self._logger = node.get_logger().get_child("action_server")

    action_type = property(attrgetter("_action_type"))

    # What the executor asks ------------------------------------------------------------------------------------------

    def is_ready(self, wait_set: Any) -> bool:
        return self._has_old_goals() or any(self._handle.requests.values())

    def take_data(self) -> Any:
        return {part: self._handle.take(part) for part in (GOAL, CANCEL, RESULT)}

    async def execute(self, taken_data: Any) -> None:
        self._forget_old_goals()
        if (taken := taken_data[GOAL]) is not None:
            await self._execute_goal_request(*taken)
        if (taken := taken_data[CANCEL]) is not None:
            await self._execute_cancel_request(*taken)
        if (taken := taken_data[RESULT]) is not None:
            self._execute_get_result_request(*taken)

    def get_num_entities(self) -> NumberOfEntities:
        return NumberOfEntities(num_timers=1, num_services=3)

    def add_to_wait_set(self, wait_set: Any) -> None:
        """Do nothing: the graph puts the requests."""

    # Requests --------------------------------------------------------------------------------------------------------

    async def _execute_goal_request(self, request: Any, reply: Callable[[Any], None]) -> None:
        key = bytes(request.goal_id.uuid)
        is_accepted = False
        if key not in self._goal_handles:
            answer = await _awaited(self._goal_callback(request.goal))
            is_accepted = answer == GoalResponse.ACCEPT
            if not isinstance(answer, GoalResponse):
                self._logger.warning("Goal request callback did not return a GoalResponse type. Rejecting goal.")
        info = message_class("action_msgs/msg/GoalInfo")(goal_id=request.goal_id)
        if is_accepted:
            info.stamp = self._node.get_clock().now().to_msg()
            self._goal_handles[key] = ServerGoalHandle(self, info, request.goal)
            self._result_futures[key] = Future()
        reply(self._action_type.Impl.SendGoalService.Response(accepted=is_accepted, stamp=info.stamp))
        if is_accepted:
            await _awaited(self._handle_accepted_callback(self._goal_handles[key]))

    async def _execute_cancel_request(self, request: Any, reply: Callable[[Any], None]) -> None:
        response = self._action_type.Impl.CancelGoalService.Response()
        response.return_code, chosen = self._to_cancel(request.goal_info)
        canceling = []
        for handle in chosen:
            if await _awaited(self._cancel_callback(handle)) == CancelResponse.ACCEPT and handle.is_active:
                if not handle.is_cancel_requested:
                    handle._update_state(GoalEvent.CANCEL_GOAL)
                canceling.append(handle._goal_info)
        response.goals_canceling = canceling
        reply(response)

    def _to_cancel(self, wanted: Any) -> tuple[int, list[ServerGoalHandle]]:
        """Return the code of the answer and the goals to cancel.

        It is one goal, or with a time those accepted until then as well, or with neither all.
        """
        key, until = bytes(wanted.goal_id.uuid), Time.from_msg(wanted.stamp).nanoseconds
        if any(key) and not until:
            handle = self._goal_handles.get(key)
            if handle is None:
                return UNKNOWN_GOAL, []
            return (0, [handle]) if handle.is_active else (ENDED_GOAL, [])
        return 0, [
            handle
            for each, handle in self._goal_handles.items()
            if handle.is_active
            and (each == key or not until or Time.from_msg(handle._goal_info.stamp).nanoseconds <= until)
        ]

    def _execute_get_result_request(self, request: Any, reply: Callable[[Any], None]) -> None:
        future = self._result_futures.get(bytes(request.goal_id.uuid))
        if future is None:
            reply(self._action_type.Impl.GetResultService.Response(status=UNKNOWN))
        else:
            future.add_done_callback(lambda done: reply(done.result()))

    # Goals -----------------------------------------------------------------------------------------------------------

    def notify_execute(self, goal_handle: ServerGoalHandle, execute_callback: Callable[[Any], Any] | None) -> None:
        """Execute a goal at the next spin."""
        callback = execute_callback or self._execute_callback
        self._node.executor.create_task(self._execute_goal, callback, goal_handle)

    def notify_goal_done(self) -> None:
        """Do nothing more: what ends is noted with its goal."""

    async def _execute_goal(self, callback: Callable[[Any], Any], handle: ServerGoalHandle) -> None:
        try:
            result = await _awaited(callback(handle))
        except Exception as error:
            result = self._action_type.Result()
            self._logger.error(f"Error raised in execute callback: {error}")
            traceback.print_exc()
        if handle.is_active:
            self._logger.warning(f"Goal state not set, assuming aborted. Goal ID: {handle.goal_id.uuid}")
            handle.abort()
        kind = self._action_type.Impl.GetResultService.Response
        response = kind(status=handle.status, result=result)
        self._result_futures[bytes(handle.goal_id.uuid)].set_result(response)

    def _publish_status(self) -> None:
        status = message_class("action_msgs/msg/GoalStatus")
        goals = [status(goal_info=item._goal_info, status=item.status) for item in self._goal_handles.values()]
        self._handle.status.publish(self._action_type.Impl.GoalStatusMessage(status_list=goals))

    def _note_end(self, handle: ServerGoalHandle) -> None:
        self._ends.append((self._task.now + self._result_timeout, bytes(handle.goal_id.uuid)))
        self.notify_goal_done()

    def _has_old_goals(self) -> bool:
        return bool(self._ends) and self._ends[0][0] <= self._task.limit

    def _forget_old_goals(self) -> None:
        while self._has_old_goals():
            _, key = self._ends.popleft()
            self._goal_handles.pop(key).destroy()
            self._result_futures.pop(key)

    # Callbacks -------------------------------------------------------------------------------------------------------

    def register_execute_callback(self, execute_callback: Callable[[Any], Any]) -> None:
        if not callable(execute_callback):
            raise TypeError("Failed to register goal execution callback: not callable")
        self._execute_callback = execute_callback

    def register_goal_callback(self, goal_callback: Callable[[Any], Any] | None) -> None:
        self._goal_callback = goal_callback or default_goal_callback

    def register_handle_accepted_callback(self, handle_accepted_callback: Callable[[Any], Any] | None) -> None:
        self._handle_accepted_callback = handle_accepted_callback or default_handle_accepted_callback

    def register_cancel_callback(self, cancel_callback: Callable[[Any], Any] | None) -> None:
        self._cancel_callback = cancel_callback or default_cancel_callback

    def destroy(self) -> None:
        for handle in self._goal_handles.values():
            handle.destroy()
        self._handle.destroy_when_not_in_use()
        self._node.remove_waitable(self)


async def _awaited(found: Any) -> Any:
    return await found if inspect.isawaitable(found) else found
