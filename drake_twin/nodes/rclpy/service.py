"""Stand-in for ``rclpy.service``."""

import inspect
from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar

from drake_twin.dataclass import dataclass
from drake_twin.nodes import message_classes
from drake_twin.nodes.graph_items import Offer
from drake_twin.nodes.rclpy.handle import Handle
from drake_twin.nodes.rclpy.node_handle import NodeHandle
from drake_twin.nodes.rclpy.service_introspection import Introspection
from drake_twin.nodes.task import present_task

SrvType, SrvTypeRequest, SrvTypeResponse = TypeVar("SrvType"), TypeVar("SrvTypeRequest"), TypeVar("SrvTypeResponse")


@dataclass(frozen=True)
class RequestHeader:
    """What is known of a request.

    Attributes:
        reply: Takes the response.
        source_timestamp: When it arrived (ns).
        received_timestamp: When it arrived (ns).
    """

    reply: Callable[[Any], None]
    source_timestamp: int

    @property
    def received_timestamp(self) -> int:
        return self.source_timestamp


class ServiceHandle(Handle):
    """What a service is on the graph.

    Args:
        node: Its node.
        srv_type: The class of the service.
        name: Its full name.

    Attributes:
        node: The node.
        item: What it has on the graph.
        requests: The requests that wait.
        introspection: The events that it publishes.
    """

    def __init__(self, node: NodeHandle, srv_type: Any, name: str):
        super().__init__(lambda: node.graph.withdraw(self.item), name, node.logger_name)
        self.node = node
        self._task = present_task()
        self.requests: deque[tuple[Any, RequestHeader]] = deque()
        self.item = Offer(name, message_classes.type_name(srv_type), node.name, self._put)
        self.introspection = Introspection(node, srv_type, name)
        node.graph.offer(self.item)
        present_task().program.belongings.append(self.item)

    def _put(self, request: Any, reply: Callable[[Any], None]) -> None:
        self.requests.append((request, RequestHeader(reply, self._task.now)))

    def _is_ready(self) -> bool:
        """Return whether a request waits."""
        return bool(self.requests)

    def service_take_request(self, pyrequest_type: Any) -> tuple[Any, "RequestHeader | None"]:
        """Return the next request with its header; None for both without one."""
        self.check()
        if not self.requests:
            present_task().count_idle_call()
            return None, None
        request, header = self.requests.popleft()
        given = message_classes.from_wire(f"{self.item.type}_Request", request)
        self.introspection.note("REQUEST_RECEIVED", given)
        return given, header

    def service_send_response(self, pyresponse: Any, header: "RequestHeader") -> None:
        """Answer a request."""
        self.check()
        self.introspection.note("RESPONSE_SENT", pyresponse)
        header.reply(message_classes.to_wire(pyresponse))


class Service:
    """Answers requests."""

    def __init__(
        self,
        service_impl: Any,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        callback_group: Any,
        qos_profile: Any,
    ):
        self._impl: ServiceHandle = service_impl
        self.srv_type, self.srv_name, self.callback = srv_type, srv_name, callback
        self.callback_group, self.qos_profile = callback_group, qos_profile

    handle = property(lambda self: self._impl)

    @property
    def service_name(self) -> str:
        self._impl.check()
        return self._impl.name

    def _is_ready(self) -> bool:
        return self._impl._is_ready()

    def _execute(self) -> Any:
        given, header = self._impl.service_take_request(self.srv_type.Request)
        if header is None:
            return None
        response = self.callback(given, self.srv_type.Response())
        if inspect.iscoroutine(response):
            return self._reply_later(response, header)
        self.send_response(response, header)
        return None

    async def _reply_later(self, response: Any, header: RequestHeader) -> None:
        self.send_response(await response, header)

    def send_response(self, response: Any, header: RequestHeader) -> None:
        if not isinstance(response, self.srv_type.Response):
            raise TypeError(f"Expected {self.srv_type.Response}, got {type(response)}")
        self._impl.service_send_response(response, header)

    def configure_introspection(self, clock: Any, service_event_qos_profile: Any, introspection_state: Any) -> None:
        self._impl.check()
        self._impl.introspection.configure(clock, service_event_qos_profile, introspection_state)

    def destroy(self) -> None:
        self._impl.introspection.end()
        self._impl.destroy_when_not_in_use()
