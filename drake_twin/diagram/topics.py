"""The topics of a twin: each is a port of the root diagram, named like the topic without the leading slash.

As in ROS, several robots may listen to one topic, and several may publish on it. The port of each further one has the
topic's name with ``@ROBOT/CONTROLLER`` after it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import chain, count
from typing import Any

from pydrake.systems.framework import Context, Diagram, DiagramBuilder, InputPort, OutputPort

from drake_twin.errors import InputError
from drake_twin.messages.draft import Draft
from drake_twin.systems.plant_reading import Reading

CLOCK, TF = "/clock", "/tf"


@dataclass(frozen=True)
class PublishedTopic:
    """A topic that the twin publishes.

    Attributes:
        topic: Its name.
        type: The ROS message type.
        port: The output port of the message.
        rate: The rate at which ROS would publish it (Hz); None if it never changes, so that once is enough.
        robot: The robot that it belongs to; empty for the twin's own.
        controller: The controller that publishes it while active; empty if it is always published.
        sensor: The sensor that measures it, at multiples of 1 / rate only: its link or joint and its name.
        drafter: Drafts its messages; None if they are evaluated whole.
        delay: How long after its measurement a message is published (s); None for at once.
        offset: How long after multiples of 1 / rate it is published (s).
        publication: Returns what tells the message that the port has from an earlier one, given the root context; None
            if the port has a new one at any time.
        draft_at: Drafts the message of any time (s), if it follows from the time alone.
    """

    topic: str
    type: str
    port: OutputPort
    rate: float | None
    robot: str = ""
    controller: str = ""
    sensor: str = ""
    drafter: Callable[[Reading], Draft] | None = None
    delay: float | None = None
    offset: float = 0.0
    publication: Callable[[Context], Any] | None = None
    draft_at: Callable[[float], Draft] | None = None


@dataclass(frozen=True)
class CommandTopic:
    """A topic or an action that a controller subscribes to.

    Attributes:
        topic: Its name.
        type: The ROS message or action type.
        port: The input port, for values as the controller's ``read`` returns them.
        robot: The robot.
        controller: The controller's name.
        name: The topic below the controller's name.
    """

    topic: str
    type: str
    port: InputPort
    robot: str
    controller: str
    name: str


class Topics:
    """Collect the topics while the diagram is built, and export each topic's port under its name.

    Attributes:
        published: Port → topic, message type, rate (Hz), robot, controller and sensor.
        subscribed: Port → topic, message type, robot, controller and the controller's own topic.
        actions: The same, for actions.
    """

    def __init__(self, builder: DiagramBuilder):
        self._builder = builder
        self._more: dict[str, dict[str, Any]] = {}
        self.published: dict[str, tuple[str, str, float | None, tuple[str, str, str]]] = {}
        self.subscribed: dict[str, tuple[str, str, tuple[str, str, str]]] = {}
        self.actions: dict[str, tuple[str, str, tuple[str, str, str]]] = {}

    def publish(
        self,
        topic: str,
        port: OutputPort,
        kind: str,
        rate: float | None,
        robot: str = "",
        controller: str = "",
        sensor: str = "",
        **more: Any,
    ) -> None:
        """Export an output port under a topic's name.

        If several controllers of one robot publish the same type on one topic, only the first does, except on ``/tf``.

        Args:
            topic: The topic.
            port: The port with its messages.
            kind: Their ROS type.
            rate: As in `PublishedTopic`, like the following.
            robot: The robot.
            controller: The controller.
            sensor: The sensor.
            **more: The other fields of `PublishedTopic`.

        Raises:
            InputError: If another message type is published on the topic.
        """
        if topic in self.published:
            _, known, _, (owner, *_) = self.published[topic]
            if topic != TF and robot and (known, owner) == (kind, robot):
                return
            _refuse_other_type(topic, known, kind, owner, robot)
        name = _port_name(topic, self.published, robot, controller)
        self._builder.ExportOutput(port, name[1:])
        self.published[name] = (topic, kind, rate, (robot, controller, sensor))
        self._more[name] = more

    def listen(self, topic: str, port: InputPort, kind: str, *owner: str, action: bool = False) -> None:
        """Export an input port under the name of a topic or an action.

        Args:
            topic: The full name.
            port: The controller's port.
            kind: The ROS type.
            *owner: The robot, the controller and the controller's own topic.
            action: Whether the port is that of an action.

        Raises:
            InputError: If another controller has the action, or subscribes to the topic with another type.
        """
        robot, controller, own = owner
        known = self.actions if action else self.subscribed
        if topic in known:
            _, kind_before, before = known[topic]
            if action:
                raise InputError(f"robots {before[0]!r} and {robot!r} would both have the action {topic}")
            _refuse_other_type(topic, kind_before, kind, before[0], robot)
        name = _port_name(topic, known, robot, controller)
        self._builder.ExportInput(port, name[1:])
        known[name] = (topic, kind, (robot, controller, own))

    def published_of(self, diagram: Diagram) -> dict[str, PublishedTopic]:
        """Return the published topics of the built diagram."""
        return {
            name: PublishedTopic(topic, kind, diagram.GetOutputPort(name[1:]), rate, *owner, **self._more[name])
            for name, (topic, kind, rate, owner) in self.published.items()
        }

    def commanded_of(self, diagram: Diagram) -> dict[str, CommandTopic]:
        """Return the topics of the built diagram that controllers subscribe to."""
        return _ports(diagram, self.subscribed)

    def actions_of(self, diagram: Diagram) -> dict[str, CommandTopic]:
        """Return the actions of the built diagram."""
        return _ports(diagram, self.actions)


def ports_by_topic(ports: Mapping[str, PublishedTopic] | Mapping[str, CommandTopic]) -> dict[str, tuple[str, ...]]:
    """Return each topic with the ports that it has."""
    found: dict[str, tuple[str, ...]] = {}
    for name, item in ports.items():
        found[item.topic] = (*found.get(item.topic, ()), name)
    return found


def _ports(diagram: Diagram, known: Mapping[str, tuple[str, str, tuple[str, str, str]]]) -> dict[str, CommandTopic]:
    return {
        name: CommandTopic(topic, kind, diagram.GetInputPort(name[1:]), *owner)
        for name, (topic, kind, owner) in known.items()
    }


def _port_name(topic: str, known: Mapping[str, object], robot: str, controller: str) -> str:
    """Return a port's name that is free: the topic's, or for a further port one with its owner."""
    owned = f"{topic}@{robot}/{controller}"
    names = chain((topic, owned), (f"{owned}/{number}" for number in count(2)))
    return next(name for name in names if name not in known)


def _refuse_other_type(topic: str, known: str, kind: str, owner: str, robot: str) -> None:
    if known != kind:
        what = f"{topic} would have two types: {known} for robot {owner!r} and {kind} for {robot!r}"
        raise InputError(f"{what}. Give each its own namespace")
