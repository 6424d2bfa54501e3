"""What waitables of a user's own are made of: entities of ``rclpy._rclpy_pybind11``, without a callback."""

from collections import deque
from typing import Any

from drake_twin.nodes import message_classes
from drake_twin.nodes.rclpy.client import ClientHandle
from drake_twin.nodes.rclpy.node_handle import NodeHandle
from drake_twin.nodes.rclpy.qos_profiles import rmw_qos_profile_t
from drake_twin.nodes.rclpy.service import ServiceHandle
from drake_twin.nodes.rclpy.subscription import SubscriptionHandle
from drake_twin.nodes.rclpy.timer import Timer as CallingTimer
from drake_twin.nodes.rclpy.waitable import WaitedHandle
from drake_twin.nodes.task import present_task


class Subscription(SubscriptionHandle):
    """A subscription whose messages are taken by ``take_message``."""

    def __init__(self, node: NodeHandle, pymsg_type: Any, topic: str, pyqos_profile: rmw_qos_profile_t):
        super().__init__(node, pymsg_type, node.remapped(node.expanded(topic)), pyqos_profile.profile)
        self.subscribe()


class Service(ServiceHandle):
    """A service whose requests are taken by ``service_take_request``."""

    def __init__(self, node: NodeHandle, pysrv_type: Any, service_name: str, pyqos_profile: rmw_qos_profile_t):
        super().__init__(node, pysrv_type, node.remapped(node.expanded(service_name)))


class Client(ClientHandle):
    """A client whose responses are taken by ``take_response``."""

    def __init__(self, node: NodeHandle, pysrv_type: Any, service_name: str, pyqos_profile: rmw_qos_profile_t):
        super().__init__(node, pysrv_type, node.remapped(node.expanded(service_name)))
        self._responses: deque[tuple[int, Any]] = deque()
        self._count = 0

    def service_server_is_available(self) -> bool:
        present_task().count_idle_call()
        self.check()
        return bool(self.node.graph.has_service(self.item.name, self.item.type))

    def send_request(self, pyrequest: Any) -> int:
        """Ask; return the number of the request."""
        self.check()
        self._count += 1
        number, request = self._count, message_classes.to_wire(pyrequest)
        self.node.graph.ask(
            self.item.name, self.item.type, request, lambda response: self._responses.append((number, response))
        )
        return number

    def _is_ready(self) -> bool:
        """Return whether a response waits."""
        return bool(self._responses)

    def take_response(self, pyresponse_type: Any) -> tuple[int, Any] | tuple[None, None]:
        """Return the number of a request and its response; None for both without one."""
        self.check()
        if not self._responses:
            return None, None
        number, response = self._responses.popleft()
        return number, message_classes.from_wire(f"{self.item.type}_Response", response)


class GuardCondition(WaitedHandle):
    """Is ready once after each trigger."""

    def __init__(self, context: Any):
        super().__init__(lambda: None, lambda: self._is_triggered, lambda: setattr(self, "_is_triggered", False))
        self._is_triggered = False

    def trigger_guard_condition(self) -> None:
        self.check()
        self._is_triggered = True


class Timer(WaitedHandle):
    """Is ready at a period of simulation time, until it is called."""

    def __init__(self, clock: Any, context: Any, period_nsec: int, autostart: bool = True):
        self._timer = CallingTimer(lambda: None, None, period_nsec, None, context=context, autostart=autostart)
        super().__init__(self._timer.destroy, self._timer._is_ready)
        self._graph, self._period = present_task().program.rclpy["graph"], period_nsec
        self._wake_later()

    def call_timer(self) -> None:
        self.check()
        self._timer._execute()
        self._wake_later()

    def _wake_later(self) -> None:
        """Let executors look at it in time."""
        self._graph.post(lambda: None, self._period)
