"""The topics of gz-sim's ApplyLinkWrench, by which messages push links."""

from math import isfinite
from typing import Any

from drake_twin import messages
from drake_twin.errors import CommandError, InputError
from drake_twin.scenario import LONGEST_TIME
from drake_twin.twin.entity_state import Wrench, find_body
from drake_twin.twin.session import Session

_WRENCH, _ENTITY = "ros_gz_interfaces/msg/EntityWrench", "ros_gz_interfaces/msg/Entity"
_TYPES = {0, 2, 3}  # of ros_gz_interfaces/msg/Entity: none, a model, a link
_ONCE, _PERSISTENT, _CLEAR = "topic", "topic_persistent", "topic_clear"


class WrenchTopics:
    """What messages on the world's topics do to its wrenches.

    Behaves as gz-sim's ApplyLinkWrench (from its source): a wrench is in the world's axes and acts at the origin of a
    link, or of a model's root link; one that stays may be for an entity that comes later.

    Args:
        session: The session.
    """

    def __init__(self, session: Session):
        self._session = session

    @property
    def types(self) -> dict[str, str]:
        """Topic → ROS message type."""
        return {topic: _ENTITY if kind == _CLEAR else _WRENCH for topic, kind in self._kinds().items()}

    def read(self, topic: str, data: Any) -> Any:
        """Return the message of one of the topics.

        Raises:
            CommandError: If it does not fit the topic, is about something else than a link or a model, has a number
                that is not finite, or is for one step of an entity that does not exist.
        """
        try:
            message = messages.message(self.types[topic], data)
        except (TypeError, ValueError) as error:
            raise CommandError(f"{topic}: {error}") from None
        kind = self._kinds()[topic]
        entity = message if kind == _CLEAR else message.entity
        if entity.type not in _TYPES or not entity.name:
            raise CommandError(f"{topic}: a wrench is on a link or a model, by its name")
        if kind != _CLEAR and not all(map(isfinite, (*_three(message.wrench.force), *_three(message.wrench.torque)))):
            raise CommandError(f"{topic}: a number of the wrench is not finite")
        if kind == _ONCE:
            try:
                find_body(self._session.built, entity.name)
            except InputError as error:
                raise CommandError(f"{topic}: {error.message}", value=error.value, valid=error.valid) from None
        return message

    def hear(self, topic: str, data: Any) -> None:
        """Do what a message says.

        Raises:
            CommandError: If it is refused, see `read`: nothing is changed then.
        """
        message, kind = self.read(topic, data), self._kinds()[topic]
        wrenches, clock = self._session.wrenches, self._session.clock
        if kind == _CLEAR:
            wrenches.keep([item for item in wrenches.steady if item.entity != message.name])
            return
        force, torque = _three(message.wrench.force), _three(message.wrench.torque)
        if kind == _PERSISTENT:
            wrenches.keep([*wrenches.steady, Wrench(message.entity.name, force, torque, LONGEST_TIME)])
            return
        wrenches.drop_ended(clock.time)
        until = min(clock.time + clock.time_step, LONGEST_TIME)
        wrenches.put([*wrenches.items, Wrench(message.entity.name, force, torque, until)])

    def _kinds(self) -> dict[str, str]:
        """Return topic → which of a plugin's topics it is; a topic of the diagram stays what it is."""
        built = self._session.physics.built
        systems = () if built.world_file is None else built.world_file.wrench_systems
        found = {getattr(system, kind): kind for system in systems for kind in (_CLEAR, _PERSISTENT, _ONCE)}
        return {topic: kind for topic, kind in found.items() if topic not in built.commanded}


def _three(vector: Any) -> tuple[float, float, float]:
    return vector.x, vector.y, vector.z
