"""Stand-in for ``rclpy.client``."""

from collections import deque
from collections.abc import Callable
from functools import partial
from operator import attrgetter
from typing import Any

from drake_twin.nodes import message_classes
from drake_twin.nodes.graph import Graph
from drake_twin.nodes.graph_items import Caller
from drake_twin.nodes.rclpy.task import Future
from drake_twin.nodes.simulated_time import wait_until
from drake_twin.nodes.task import present_task


class Client:
    """Asks a service."""

    def __init__(
        self,
        graph: Graph,
        context: Any,
        srv_type: Any,
        srv_name: str,
        qos_profile: Any,
        callback_group: Any,
        node: str,
    ):
        self.srv_type, self.srv_name, self.qos_profile = srv_type, srv_name, qos_profile
        self.callback_group, self.context = callback_group, context
        self._service_name = srv_name
        self._graph = graph
        self._type = message_classes.type_name(srv_type)
        self._answers: deque[Callable[[], None]] = deque()
        self._pending: list[Future] = []
        self._executor: Any = None
        self._caller = Caller(srv_name, self._type, node)
        graph.outside.add(self._caller)
        present_task().program.belongings.append(self._caller)

    service_name = property(attrgetter("_service_name"))

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """Ask, and wait for the answer while another thread spins."""
        future = self.call_async(request)
        if not wait_until(present_task(), lambda: future.has_ended, timeout_sec):
            return None
        return future.result()

    def call_async(self, request: Any) -> Future:
        present_task()
        if not isinstance(request, self.srv_type.Request):
            raise TypeError(f"Expected {self.srv_type.Request}, got {type(request)}")
        future = Future()
        self._pending.append(future)

        def answered(response: Any) -> None:
            self._answers.append(partial(self._finish, future, response))

        self._graph.ask(self.srv_name, self._type, message_classes.to_wire(request), answered)
        return future

    def _finish(self, future: Future, response: Any) -> None:
        if future in self._pending:
            self._pending.remove(future)
            future.set_result(message_classes.from_wire(f"{self._type}_Response", response))

    def remove_pending_request(self, future: Future) -> None:
        if future in self._pending:
            self._pending.remove(future)

    def service_is_ready(self) -> bool:
        present_task().count_idle_call()
        return self._graph.has_service(self.srv_name, self._type)

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        ready = partial(self._graph.has_service, self.srv_name, self._type)
        return wait_until(present_task(), lambda: ready() or not self.context.is_valid, timeout_sec) and ready()

    def is_ready(self) -> bool:
        return bool(self._answers)

    def execute(self) -> None:
        self._answers.popleft()()

    def destroy(self) -> None:
        self._pending.clear()
        self._answers.clear()
        self._graph.withdraw(self._caller)
