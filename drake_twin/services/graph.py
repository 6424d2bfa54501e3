"""All that a twin answers on the graph, and its actions' news; goals survive a spawn and a delete."""

from collections.abc import Iterator

from drake_twin.services.actions import ActionServer, Publication, action_servers
from drake_twin.services.registry import Fields, Service, services_of
from drake_twin.twin.twin import Twin


class GraphServices:
    """The services and actions of a twin.

    Args:
        twin: The twin.
    """

    def __init__(self, twin: Twin):
        self._twin = twin
        self._actions: dict[str, ActionServer] = {}

    def services(self) -> tuple[Service, ...]:
        """Return the services with the present robots, those of actions among them."""
        present = {server.name: server for server in action_servers(self._twin)}
        self._actions = {name: self._actions.get(name, server) for name, server in present.items()}
        of_actions = (service for server in self._actions.values() for service in server.services())
        return (*services_of(self._twin), *of_actions)

    def publications(self) -> tuple[tuple[Publication, str], ...]:
        """Return the topics of the actions, each with the full name of its node."""
        return tuple(
            (topic, server.node)
            for server in self._actions.values()
            for topic in (server.feedback_topic, server.status_topic)
        )

    def news(self) -> Iterator[tuple[Publication, Fields]]:
        """Yield the messages of actions that are due."""
        for server in self._actions.values():
            yield from server.news()
