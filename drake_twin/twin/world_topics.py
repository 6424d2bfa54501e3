"""The topics by which messages act on the world itself: its wrenches and its wind."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from drake_twin.twin.endpoints import COMMANDED, TWIN_NODE, Endpoint
from drake_twin.twin.session import Session

if TYPE_CHECKING:
    from drake_twin.twin.wind_topics import WindTopics
    from drake_twin.twin.wrench_topics import WrenchTopics


class WorldTopics:
    """The topics of the plugins of a world.

    Args:
        session: The session.
    """

    def __init__(self, session: Session):
        self._session = session

    @property
    def types(self) -> dict[str, str]:
        """Topic → ROS message type."""
        return {topic: kind for part in self._parts() for topic, kind in part.types.items()}

    def endpoints(self) -> tuple[Endpoint, ...]:
        """Return the topics as part of the graph."""
        return tuple(Endpoint(COMMANDED, topic, kind, TWIN_NODE) for topic, kind in self.types.items())

    def read(self, topic: str, data: Any) -> Any:
        """Return the message of one of the topics.

        Raises:
            CommandError: If it is refused.
        """
        return self._of(topic).read(topic, data)

    def hear(self, topic: str, data: Any) -> None:
        """Do what a message says.

        Raises:
            CommandError: If it is refused: nothing is changed then.
        """
        self._of(topic).hear(topic, data)

    def _of(self, topic: str) -> "WrenchTopics | WindTopics":
        return next(part for part in self._parts() if topic in part.types)

    def _parts(self) -> "Iterator[WrenchTopics | WindTopics]":
        world_file = self._session.physics.built.world_file
        if world_file is not None and world_file.wrench_systems:
            from drake_twin.twin.wrench_topics import WrenchTopics

            yield WrenchTopics(self._session)
        if world_file is not None and world_file.wind_effects is not None:
            from drake_twin.twin.wind_topics import WindTopics

            yield WindTopics(self._session)
