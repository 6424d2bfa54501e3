"""All that a twin answers on the graph, and its actions' news; goals survive a spawn and a delete."""

from collections.abc import Iterator, Sequence

from drake_twin.services.actions import ActionServer, action_servers
from drake_twin.services.registry import Fields, Service, services_of
from drake_twin.twin.endpoints import Endpoint
from drake_twin.twin.twin import Twin
from drake_twin.wires.seam import Seam
from drake_twin.wires.wire import Wire


def connect(twin: Twin, wires: Sequence[Wire]) -> Seam:
    """Connect a twin, with its services and actions, to wires.

    Args:
        twin: The twin.
        wires: The wires.

    Returns:
        The connection; close it to end the wires.
    """
    services = GraphServices()
    return Seam(twin, wires, services.services, services)


class GraphServices:
    """The services and actions of a twin."""

    def __init__(self) -> None:
        self._actions: dict[str, ActionServer] = {}

    def loaded(self, twin: Twin) -> tuple[tuple[str, ...], ...]:
        """Return the loaded controllers of each robot, which are nodes."""
        return tuple(tuple(twin.controller_manager(robot).states) for robot in twin.robots)

    def services(self, twin: Twin) -> tuple[Service, ...]:
        """Return the services with the present robots, those of actions among them."""
        present = {server.name: server for server in action_servers(twin)}
        self._actions = {name: self._actions.get(name, server) for name, server in present.items()}
        of_actions = (service for server in self._actions.values() for service in server.services())
        return (*services_of(twin), *of_actions)

    def topics(self) -> tuple[Endpoint, ...]:
        """Return the topics of the actions."""
        servers = self._actions.values()
        return tuple(topic for server in servers for topic in (server.feedback_topic, server.status_topic))

    def news(self) -> Iterator[tuple[str, Fields]]:
        """Yield the messages of actions that are due: their topics and their fields."""
        for server in self._actions.values():
            yield from server.news()
