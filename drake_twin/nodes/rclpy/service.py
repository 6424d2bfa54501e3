"""Stand-in for ``rclpy.service``."""

import inspect
from collections import deque
from collections.abc import Callable
from operator import attrgetter
from typing import Any

from drake_twin.nodes import message_classes
from drake_twin.nodes.graph import Graph
from drake_twin.nodes.graph_items import Offer
from drake_twin.nodes.task import present_task


class Service:
    """Answers requests."""

    def __init__(
        self,
        graph: Graph,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        callback_group: Any,
        qos_profile: Any,
        node: str,
    ):
        self.srv_type, self.srv_name, self.callback = srv_type, srv_name, callback
        self.callback_group, self.qos_profile = callback_group, qos_profile
        self._service_name = srv_name
        self._graph = graph
        self._type = message_classes.type_name(srv_type)
        self._requests: deque[tuple[Any, Callable[[Any], None]]] = deque()
        self._offer = Offer(srv_name, self._type, node, lambda request, reply: self._requests.append((request, reply)))
        graph.offer(self._offer)
        present_task().program.belongings.append(self._offer)

    service_name = property(attrgetter("_service_name"))

    def is_ready(self) -> bool:
        return bool(self._requests)

    def execute(self) -> Any:
        request, reply = self._requests.popleft()
        given = message_classes.from_wire(f"{self._type}_Request", request)
        response = self.callback(given, self.srv_type.Response())
        if inspect.iscoroutine(response):
            return self._reply_later(response, reply)
        self._reply(response, reply)
        return None

    async def _reply_later(self, response: Any, reply: Callable[[Any], None]) -> None:
        self._reply(await response, reply)

    def _reply(self, response: Any, reply: Callable[[Any], None]) -> None:
        if not isinstance(response, self.srv_type.Response):
            raise TypeError(f"Expected {self.srv_type.Response}, got {type(response)}")
        reply(message_classes.to_wire(response))

    def send_response(self, response: Any, header: Any) -> None:
        raise NotImplementedError("Service.send_response: in the twin, what a service's callback returns is its answer")

    def destroy(self) -> None:
        self._graph.withdraw(self._offer)
