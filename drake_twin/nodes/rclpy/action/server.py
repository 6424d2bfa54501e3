"""Stand-in for ``rclpy.action.server``."""

import inspect
from collections.abc import Callable
from enum import Enum
from functools import partial
from operator import attrgetter
from typing import Any

from drake_twin.nodes import message_classes
from drake_twin.nodes.action_graph import (
    ABORTED,
    ACCEPTED,
    CANCELED,
    CANCELING,
    ENDED_GOAL,
    EXECUTING,
    NO_ERROR,
    REJECTED,
    SUCCEEDED,
    UNKNOWN,
    UNKNOWN_GOAL,
)
from drake_twin.nodes.graph_items import GoalListener
from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy._rclpy_pybind11 import RCLError
from drake_twin.nodes.rclpy.action.graph import action_full_name
from drake_twin.nodes.rclpy.handle import Handle
from drake_twin.nodes.rclpy.type_support import check_is_valid_action_type
from drake_twin.nodes.rclpy.waitable import GraphWaitable
from drake_twin.nodes.task import present_task


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

    def __init__(self, action_server: "ActionServer", key: bytes, request: Any, listener: GoalListener):
        self._server, self._key, self._request, self._listener = action_server, key, request, listener
        self._status = ACCEPTED

    request, status = property(attrgetter("_request")), property(attrgetter("_status"))

    @property
    def goal_id(self) -> Any:
        uuid = message_class("unique_identifier_msgs/msg/UUID")

        return uuid(uuid=list(self._key))

    @property
    def is_active(self) -> bool:
        return self._status in (ACCEPTED, EXECUTING, CANCELING)

    @property
    def is_cancel_requested(self) -> bool:
        present_task()
        return self._status == CANCELING

    def execute(self, execute_callback: Callable[[Any], Any] | None = None) -> None:
        if not self.is_cancel_requested:
            self._status = EXECUTING
        self._server.notify_execute(self, execute_callback)

    def publish_feedback(self, feedback: Any) -> None:
        present_task()
        kind = self._server.action_type.Feedback
        if not isinstance(feedback, kind):
            raise TypeError
        self._server.post(partial(self._listener.heard, message_classes.to_wire(feedback)))

    def succeed(self) -> None:
        self._end(SUCCEEDED)

    def abort(self) -> None:
        self._end(ABORTED)

    def canceled(self) -> None:
        self._end(CANCELED)

    def destroy(self) -> None:
        self._server.forget(self._key)

    def _end(self, status: int) -> None:
        if not self.is_active or (status == CANCELED and self.status != CANCELING):
            raise RCLError("Failed to update goal state: goal_handle attempted invalid transition")
        self._status = status

    def _request_cancel(self) -> None:
        self._status = CANCELING

    def _tell(self, result: Any) -> None:
        self._server.post(partial(self._listener.ended, self.status, message_classes.to_wire(result)))


def default_handle_accepted_callback(goal_handle: ServerGoalHandle) -> None:
    goal_handle.execute()


def default_goal_callback(goal_request: Any) -> GoalResponse:
    return GoalResponse.ACCEPT


def default_cancel_callback(cancel_request: Any) -> CancelResponse:
    return CancelResponse.REJECT


class ActionServer(GraphWaitable):
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
        feedback_pub_qos_profile: Any = None,
        status_pub_qos_profile: Any = None,
        result_timeout: int = 900,
    ):
        self.register_execute_callback(execute_callback)
        check_is_valid_action_type(action_type)
        super().__init__(callback_group or node.default_callback_group)
        self._action_type = action_type
        self.name, self.node = action_full_name(node, action_name, "server"), node.get_fully_qualified_name()
        self._handle = Handle(self._end, self.name)
        self.type = message_classes.type_name(action_type)
        self._ros_node = node
        self._goal_callback = goal_callback
        self._accepted_callback, self._cancel_callback = handle_accepted_callback, cancel_callback
        self._handles: dict[bytes, ServerGoalHandle] = {}
        self._actions = node._twin_actions
        self._actions.offer(self)
        present_task().program.belongings.append(self)
        node.add_waitable(self)

    # What the graph asks ---------------------------------------------------------------------------------------------

    def put_goal(self, key: bytes, goal: Any, listener: GoalListener) -> None:
        self._events.append(partial(self._take_goal, key, goal, listener))

    def put_cancel(self, key: bytes, answered: Callable[[int], None]) -> None:
        self._events.append(partial(self._take_cancel, key, answered))

    def status_of(self, key: bytes) -> int:
        handle = self._handles.get(key)
        return UNKNOWN if handle is None else handle.status

    # What the executor asks ------------------------------------------------------------------------------------------

    async def _awaited(self, found: Any) -> Any:
        return await found if inspect.isawaitable(found) else found

    async def _take_goal(self, key: bytes, goal: Any, listener: GoalListener) -> None:
        request = message_classes.from_wire(f"{self.type}_Goal", goal)
        is_accepted = key not in self._handles and (
            await self._awaited(self._goal_callback(request)) == GoalResponse.ACCEPT
        )
        self.post(partial(listener.answered, is_accepted))
        if is_accepted:
            handle = self._handles[key] = ServerGoalHandle(self, key, request, listener)
            await self._awaited(self._accepted_callback(handle))

    async def _take_cancel(self, key: bytes, answered: Callable[[int], None]) -> None:
        handle, code = self._handles.get(key), UNKNOWN_GOAL
        if handle is not None and not handle.is_active:
            code = ENDED_GOAL
        elif handle is not None:
            code = REJECTED
            if await self._awaited(self._cancel_callback(handle)) == CancelResponse.ACCEPT:
                handle._request_cancel()
                code = NO_ERROR
        self.post(partial(answered, code))

    # What a goal asks ------------------------------------------------------------------------------------------------

    action_type = property(attrgetter("_action_type"))

    def notify_goal_done(self) -> None:
        """Do nothing: a result is kept as long as its server."""

    def post(self, act: Callable[[], None]) -> None:
        """Let something happen in the next slot."""
        self._actions.post(act)

    def notify_execute(self, goal_handle: ServerGoalHandle, execute_callback: Callable[[Any], Any] | None) -> None:
        """Execute a goal at the next spin."""
        callback = execute_callback or self._execute_callback
        self._ros_node.executor.create_task(self._execute_goal, callback, goal_handle)

    def forget(self, key: bytes) -> None:
        """Forget a goal."""
        self._handles.pop(key, None)

    async def _execute_goal(self, callback: Callable[[Any], Any], handle: ServerGoalHandle) -> None:
        logger = self._ros_node.get_logger()
        try:
            result = await self._awaited(callback(handle))
        except Exception as error:
            logger.error(f"Error raised in execute callback: {error}")
            result = self._action_type.Result()
        if handle.is_active:
            logger.warning(f"Goal state not set, assuming aborted. Goal ID: {list(handle._key)}")
            handle.abort()
        if result is None:
            result = self._action_type.Result()
        if not isinstance(result, self._action_type.Result):
            raise TypeError(f"Expected {self._action_type.Result}, got {type(result)}")
        handle._tell(result)

    def register_execute_callback(self, execute_callback: Callable[[Any], Any]) -> None:
        if not callable(execute_callback):
            raise TypeError("Failed to register goal execution callback: not callable")
        self._execute_callback = execute_callback

    def register_goal_callback(self, goal_callback: Callable[[Any], Any] | None) -> None:
        self._goal_callback = goal_callback or default_goal_callback

    def register_handle_accepted_callback(self, handle_accepted_callback: Callable[[Any], Any] | None) -> None:
        self._accepted_callback = handle_accepted_callback or default_handle_accepted_callback

    def register_cancel_callback(self, cancel_callback: Callable[[Any], Any] | None) -> None:
        self._cancel_callback = cancel_callback or default_cancel_callback

    def destroy(self) -> None:
        self._handle.destroy_when_not_in_use()

    def _end(self) -> None:
        self._actions.withdraw(self)
        self._ros_node.remove_waitable(self)
