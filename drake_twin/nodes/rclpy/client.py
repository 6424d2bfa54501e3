"""Stand-in for ``rclpy.client``."""

from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from drake_twin.nodes import message_classes
from drake_twin.nodes.graph_items import Caller
from drake_twin.nodes.rclpy.handle import Handle
from drake_twin.nodes.rclpy.node_handle import NodeHandle
from drake_twin.nodes.rclpy.service_introspection import Introspection
from drake_twin.nodes.rclpy.task import Future
from drake_twin.nodes.simulated_time import wait_until
from drake_twin.nodes.task import present_task

SrvType, SrvTypeRequest, SrvTypeResponse = TypeVar("SrvType"), TypeVar("SrvTypeRequest"), TypeVar("SrvTypeResponse")


class ClientHandle(Handle):
    """What a client is on the graph.

    Args:
        node: Its node.
        srv_type: The class of the service.
        name: The service's full name.

    Attributes:
        node: The node.
        item: What it has on the graph.
        introspection: The events that it publishes.
    """

    def __init__(self, node: NodeHandle, srv_type: Any, name: str):
        super().__init__(lambda: node.graph.withdraw(self.item), name, node.logger_name)
        self.node = node
        self.item = Caller(name, message_classes.type_name(srv_type), node.name)
        self.introspection = Introspection(node, srv_type, name)
        node.graph.outside.add(self.item)
        present_task().program.belongings.append(self.item)


class Client:
    """Asks a service."""

    def __init__(
        self,
        context: Any,
        client_impl: Any,
        srv_type: Any,
        srv_name: str,
        qos_profile: Any,
        callback_group: Any,
    ):
        self._impl: ClientHandle = client_impl
        self.srv_type, self.srv_name, self.qos_profile = srv_type, srv_name, qos_profile
        self.callback_group, self.context = callback_group, context
        self._type = client_impl.item.type
        self._answers: deque[Callable[[], None]] = deque()
        self._pending: list[Future] = []
        self.executor: Any = None

    handle = property(lambda self: self._impl)

    @property
    def service_name(self) -> str:
        self._impl.check()
        return self._impl.name

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """Ask, and wait for the answer while another thread spins."""
        self._check(request)
        future = self.call_async(request)
        if not wait_until(present_task(), lambda: future._done, timeout_sec):
            return None
        return future.result()

    def call_async(self, request: Any) -> Future:
        present_task()
        self._check(request)
        self._impl.check()
        future = Future()
        self._pending.append(future)
        future.add_done_callback(self.remove_pending_request)

        def answered(response: Any) -> None:
            self._answers.append(partial(self._finish, future, response))

        self._impl.introspection.note("REQUEST_SENT", request)
        self._impl.node.graph.ask(self._impl.name, self._type, message_classes.to_wire(request), answered)
        return future

    def _check(self, request: Any) -> None:
        if not isinstance(request, self.srv_type.Request):
            raise TypeError(f"Expected {self.srv_type.Request}, got {type(request)}")

    def _finish(self, future: Future, response: Any) -> None:
        if future in self._pending:
            given = message_classes.from_wire(f"{self._type}_Response", response)
            self._impl.introspection.note("RESPONSE_RECEIVED", given)
            future._set_executor(self.executor)
            future.set_result(given)

    def get_pending_request(self, sequence_number: int) -> Future:
        return self._pending[sequence_number]

    def remove_pending_request(self, future: Future) -> None:
        if future in self._pending:
            self._pending.remove(future)

    def service_is_ready(self) -> bool:
        present_task().count_idle_call()
        self._impl.check()
        return bool(self._impl.node.graph.has_service(self._impl.name, self._type))

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        self._impl.check()
        ready = partial(self._impl.node.graph.has_service, self._impl.name, self._type)
        return wait_until(present_task(), lambda: ready() or not self.context.is_valid, timeout_sec) and ready()

    def configure_introspection(self, clock: Any, service_event_qos_profile: Any, introspection_state: Any) -> None:
        self._impl.check()
        self._impl.introspection.configure(clock, service_event_qos_profile, introspection_state)

    def _is_ready(self) -> bool:
        return bool(self._answers)

    def _execute(self) -> None:
        self._answers.popleft()()

    def destroy(self) -> None:
        self._pending.clear()
        self._answers.clear()
        self._impl.introspection.end()
        self._impl.destroy_when_not_in_use()
