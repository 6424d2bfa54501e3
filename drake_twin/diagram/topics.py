"""The topics of a twin: each is a port of the root diagram, named like the topic without the leading slash."""

from collections.abc import Mapping
from dataclasses import dataclass

from pydrake.systems.framework import Diagram, DiagramBuilder, InputPort, OutputPort

from drake_twin.errors import InputError


@dataclass(frozen=True)
class PublishedTopic:
    """A topic that the twin publishes.

    Attributes:
        type: The ROS message type.
        port: The output port of the message.
        rate: The rate at which ROS would publish it (Hz); None if it never changes, so that once is enough.
        robot: The robot that it belongs to; empty for the twin's own.
        controller: The controller that publishes it while active; empty if it is always published.
    """

    type: str
    port: OutputPort
    rate: float | None
    robot: str = ""
    controller: str = ""


@dataclass(frozen=True)
class CommandTopic:
    """A topic or an action that a controller subscribes to.

    Attributes:
        type: The ROS message or action type.
        port: The input port, for values as the controller's ``read`` returns them.
        robot: The robot.
        controller: The controller's name.
        name: The topic below the controller's name.
    """

    type: str
    port: InputPort
    robot: str
    controller: str
    name: str


class Topics:
    """Collect the topics while the diagram is built, and export each topic's port under its name.

    Attributes:
        published: Topic → message type, rate (Hz), robot and controller.
        subscribed: Topic → message type, robot, controller and the controller's own topic.
        actions: Action → the same.
    """

    def __init__(self, builder: DiagramBuilder):
        self._builder = builder
        self.published: dict[str, tuple[str, float | None, tuple[str, str]]] = {}
        self.subscribed: dict[str, tuple[str, tuple[str, str, str]]] = {}
        self.actions: dict[str, tuple[str, tuple[str, str, str]]] = {}

    def publish(
        self, topic: str, port: OutputPort, kind: str, rate: float | None, robot: str = "", controller: str = ""
    ) -> None:
        """Export an output port under a topic's name.

        If several controllers of one robot publish the same type on one topic, only the first does.

        Raises:
            InputError: If another robot publishes on the topic.
        """
        if topic in self.published:
            known, _, (owner, _) = self.published[topic]
            if robot and (known, owner) == (kind, robot):
                return
            raise InputError(f"two robots would publish on {topic}: give each its own namespace")
        self._builder.ExportOutput(port, topic[1:])
        self.published[topic] = (kind, rate, (robot, controller))

    def listen(self, topic: str, port: InputPort, kind: str, *owner: str, action: bool = False) -> None:
        """Export an input port under the name of a topic or an action.

        Args:
            topic: The full name.
            port: The controller's port.
            kind: The ROS type.
            *owner: The robot, the controller and the controller's own topic.
            action: Whether the port is that of an action.

        Raises:
            InputError: If another controller subscribes to the topic.
        """
        robot, controller, name = owner
        known = self.actions if action else self.subscribed
        if topic in known:
            raise InputError(f"robots {known[topic][1][0]!r} and {robot!r} would both subscribe to {topic}")
        self._builder.ExportInput(port, topic[1:])
        known[topic] = (kind, (robot, controller, name))

    def published_of(self, diagram: Diagram) -> dict[str, PublishedTopic]:
        """Return the published topics of the built diagram."""
        return {
            topic: PublishedTopic(kind, diagram.GetOutputPort(topic[1:]), rate, *owner)
            for topic, (kind, rate, owner) in self.published.items()
        }

    def commanded_of(self, diagram: Diagram) -> dict[str, CommandTopic]:
        """Return the topics of the built diagram that controllers subscribe to."""
        return _ports(diagram, self.subscribed)

    def actions_of(self, diagram: Diagram) -> dict[str, CommandTopic]:
        """Return the actions of the built diagram."""
        return _ports(diagram, self.actions)


def _ports(diagram: Diagram, known: Mapping[str, tuple[str, tuple[str, str, str]]]) -> dict[str, CommandTopic]:
    return {
        topic: CommandTopic(kind, diagram.GetInputPort(topic[1:]), *owner) for topic, (kind, owner) in known.items()
    }
