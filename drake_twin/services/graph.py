"""All that a twin answers on the graph, and its actions' news; goals survive a spawn and a delete."""

from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from drake_twin.messages.text import field_names
from drake_twin.planning.controller_plan import UNCONFIGURED
from drake_twin.services.actions import ActionServer, action_servers
from drake_twin.services.offered import services_of
from drake_twin.services.registry import Fields, Later, Service
from drake_twin.twin.endpoints import Endpoint
from drake_twin.twin.twin import Twin
from drake_twin.wires.seam import Seam
from drake_twin.wires.wire import Wire

if TYPE_CHECKING:
    from drake_twin.nodes.graph import Graph
    from drake_twin.nodes.graph_items import Caller
    from drake_twin.nodes.nodes import Nodes


def connect(twin: Twin, wires: Sequence[Wire], nodes: "Nodes | None" = None) -> Seam:
    """Connect a twin, with its services and actions, to wires.

    Args:
        twin: The twin.
        wires: The wires.
        nodes: Its node programs.

    Returns:
        The connection; close it to end the wires.
    """
    services = GraphServices(None if nodes is None else nodes.graph)
    seam = Seam(twin, wires, services.services, services)
    if nodes is not None:
        nodes.graph.outside.source = seam
        nodes.graph.taps.append(lambda publication, message: seam.send(publication.topic, message))
    return seam


class GraphServices:
    """The services and actions of a twin, and the topics and services of its node programs.

    Args:
        graph: What its node programs share.
    """

    def __init__(self, graph: "Graph | None" = None) -> None:
        self._graph = graph
        self._actions: dict[str, ActionServer] = {}

    def loaded(self, twin: Twin) -> tuple[Any, ...]:
        """Return which controllers are loaded and configured, and the state of the node programs."""
        controllers = tuple(
            (robot, name, state == UNCONFIGURED)
            for robot in twin.robots
            for name, state in twin.control.manager(robot).states.items()
        )
        return *controllers, None if self._graph is None else self._graph.version

    def absent(self, twin: Twin) -> set[str]:
        """Return the nodes of controllers that are not configured: they have no topics and no actions, as in ROS."""
        waiting, configured = set[str](), set[str]()
        for plan in twin.built.plans:
            states = twin.control.manager(plan.name).states
            for item in plan.controllers:
                is_waiting = states.get(item.name, UNCONFIGURED) == UNCONFIGURED
                (waiting if is_waiting else configured).add(f"{plan.robot.topic_namespace}/{item.name}")
        return waiting - configured  # two robots may have one node

    def services(self, twin: Twin) -> tuple[Service, ...]:
        """Return the services with the present robots, those of actions among them."""
        absent = self.absent(twin)
        present = {server.name: server for server in action_servers(twin) if server.node not in absent}
        self._actions = {name: self._actions.get(name, server) for name, server in present.items()}
        of_actions = (service for server in self._actions.values() for service in server.services())
        return (*services_of(twin), *of_actions, *self._of_nodes())

    def _of_nodes(self) -> Iterator[Service]:
        if self._graph is None:
            return
        for name, (offer, *_) in self._graph.offers.items():
            yield Service(name, offer.type, offer.node, partial(self._ask, name, offer.type))

    def _ask(self, name: str, kind: str, request: Any) -> Later:
        """Ask a node's service; its response comes in a later slot."""
        assert self._graph is not None
        responses: list[Any] = []
        self._graph.ask(name, kind, request, responses.append)
        while not responses:
            yield
        response = responses[0]
        return {name: getattr(response, name) for name in field_names(response)}

    def hear(self, topic: str, message: Any) -> None:
        """Pass on to node programs what another program has published."""
        if self._graph is not None:
            self._graph.hear(topic, message)

    def kept(self, topic: str) -> Iterator[Any]:
        """Yield the messages of node programs that late joiners get."""
        if self._graph is not None:
            for publication in self._graph.publications.get(topic, ()):
                yield from publication.kept()

    def wanted(self) -> Iterator["Caller"]:
        """Yield the services of other programs that node programs ask."""
        if self._graph is not None:
            yield from self._graph.outside.wanted()

    def look_again(self) -> None:
        """Let node programs see which services of other programs have come or gone."""
        if self._graph is not None:
            self._graph.changed()

    def topics(self) -> tuple[Endpoint, ...]:
        """Return the topics of the actions and of the node programs."""
        servers = self._actions.values()
        own = (topic for server in servers for topic in (server.feedback_topic, server.status_topic))
        return (*own, *(() if self._graph is None else self._graph.endpoints()))

    def proceed(self) -> None:
        """Continue the actions' running goals, between two advances."""
        for server in self._actions.values():
            server.proceed()

    def news(self) -> Iterator[tuple[str, Fields]]:
        """Yield the messages of actions that are due: their topics and their fields."""
        for server in self._actions.values():
            yield from server.news()
