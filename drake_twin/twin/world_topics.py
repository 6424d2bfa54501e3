"""The topics by which messages act on the world itself: its wrenches and its wind."""

from typing import TYPE_CHECKING, Any

from drake_twin.twin.endpoints import COMMANDED, TWIN_NODE, Endpoint
from drake_twin.twin.session import Session
from drake_twin.twin.wrench_topics import WrenchTopics

if TYPE_CHECKING:
    from drake_twin.twin.wind_topics import WindTopics


class WorldTopics:
    """The topics of the plugins of a world.

    Args:
        session: The session.
    """

    def __init__(self, session: Session):
        self._session, self._wrenches = session, WrenchTopics(session)

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

    def _parts(self) -> "tuple[WrenchTopics | WindTopics, ...]":
        world_file = self._session.physics.built.world_file
        if world_file is None or world_file.wind_effects is None:
            return (self._wrenches,)
        from drake_twin.twin.wind_topics import WindTopics

        return self._wrenches, WindTopics(self._session)
