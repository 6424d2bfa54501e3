"""The topics of gz-sim's WindEffects, which say what a world's wind has to be."""

from math import isfinite
from typing import Any

from drake_twin import messages
from drake_twin.diagram.world_in_plant import changing_wind, wind_topic
from drake_twin.errors import CommandError
from drake_twin.twin.session import Session

_VELOCITY, _ENABLE = "geometry_msgs/msg/Vector3", "std_msgs/msg/Bool"


class WindTopics:
    """What messages do to the world's wind.

    gz-sim's topic ``/world/NAME/wind`` has a velocity and a flag, in a message that ros_gz does not know. Here it has
    the velocity, to which the wind then rises, and ``/world/NAME/wind/enable`` has the flag: without it the velocity of
    the air stays as it is, and the wind pushes no links.

    Args:
        session: The session.
    """

    def __init__(self, session: Session):
        self._session = session

    @property
    def types(self) -> dict[str, str]:
        """Topic → ROS message type."""
        built = self._session.physics.built
        assert built.world_file is not None, "its world has a plugin for it"
        topic = wind_topic(built.world_file.name)
        types = {topic: _VELOCITY, f"{topic}/enable": _ENABLE}
        return {name: kind for name, kind in types.items() if name not in built.commanded}

    def read(self, topic: str, data: Any) -> Any:
        """Return the message of one of the topics.

        Raises:
            CommandError: If it does not fit the topic, or has a number that is not finite.
        """
        try:
            message = messages.message(self.types[topic], data)
        except (TypeError, ValueError) as error:
            raise CommandError(f"{topic}: {error}") from None
        if self.types[topic] == _VELOCITY and not all(map(isfinite, (message.x, message.y, message.z))):
            raise CommandError(f"{topic}: the velocity is not finite")
        return message

    def hear(self, topic: str, data: Any) -> None:
        """Do what a message says.

        Raises:
            CommandError: If it is refused, see `read`: nothing is changed then.
        """
        message, physics = self.read(topic, data), self._session.physics
        system = changing_wind(physics.built.diagram)
        assert system is not None, "its world has a plugin for it"
        context = system.GetMyMutableContextFromRoot(physics.context)
        if self.types[topic] == _VELOCITY:
            system.tell(context, (message.x, message.y, message.z), blows=True)
        else:
            system.tell(context, None, blows=bool(message.data))
