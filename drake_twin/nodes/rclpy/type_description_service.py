"""Stand-in for ``rclpy.type_description_service``."""

from typing import Any

from drake_twin.nodes.graph_items import Offer
from drake_twin.nodes.rclpy.handle import Handle
from drake_twin.nodes.task import present_task

START_TYPE_DESCRIPTION_SERVICE_PARAM = "start_type_description_service"


class TypeDescriptionService:
    """The service that describes types: it is on the graph, and says that it knows none."""

    def __init__(self, node: Any):
        self._node = node
        graph, name = node.handle.graph, node.resolve_service_name("~/get_type_description")
        self._offer = Offer(name, "type_description_interfaces/srv/GetTypeDescription", node.handle.name, self._put)
        self._handle = Handle(lambda: graph.withdraw(self._offer), name, node.handle.logger_name)
        graph.offer(self._offer)
        present_task().program.belongings.append(self._offer)

    def _put(self, request: Any, reply: Any) -> None:
        from drake_twin.messages.interface_types import make_response

        reason = "types are described by the wires, which know them"
        reply(make_response(self._offer.type, {"successful": False, "failure_reason": reason}))

    def destroy(self) -> None:
        self._handle.destroy_when_not_in_use()
