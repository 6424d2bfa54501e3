"""The topics of a twin: each is a port of the root diagram, named like the topic without the leading slash.

As in ROS, several robots may listen to one topic, and several may publish on it. The port of each further one has the
topic's name with ``@ROBOT/CONTROLLER`` after it.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import chain, count
from typing import Any

from pydrake.systems.framework import Context, Diagram, DiagramBuilder, InputPort, OutputPort

from drake_twin.dataclass import dataclass
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
        published: Port → what is published there; its port is the system's own.
        subscribed: Port → what a controller subscribes to there.
        actions: The same, for actions.
    """

    def __init__(self, builder: DiagramBuilder):
        self._builder = builder
        self.published: dict[str, PublishedTopic] = {}
        self.subscribed: dict[str, CommandTopic] = {}
        self.actions: dict[str, CommandTopic] = {}

    def publish(self, item: PublishedTopic) -> None:
        """Export an output port under a topic's name.

        If several controllers of one robot publish the same type on one topic, only the first does, except on ``/tf``.

        Raises:
            InputError: If another message type is published on the topic.
        """
        known = self.published.get(item.topic)
        if known is not None:
            if item.topic != TF and item.robot and (known.type, known.robot) == (item.type, item.robot):
                return
            _refuse_other_type(known, item)
        name = _port_name(item, self.published)
        self._builder.ExportOutput(item.port, name[1:])
        self.published[name] = item

    def listen(self, item: CommandTopic, *, action: bool = False) -> None:
        """Export an input port under the name of a topic or an action.

        Raises:
            InputError: If another controller has the action, or subscribes to the topic with another type.
        """
        known = self.actions if action else self.subscribed
        if (before := known.get(item.topic)) is not None:
            if action:
                what = f"robots {before.robot!r} and {item.robot!r} would both have the action {item.topic}"
                raise InputError(what)
            _refuse_other_type(before, item)
        name = _port_name(item, known)
        self._builder.ExportInput(item.port, name[1:])
        known[name] = item

    def published_of(self, diagram: Diagram) -> dict[str, PublishedTopic]:
        """Return the published topics of the built diagram."""
        return {name: replace(item, port=diagram.GetOutputPort(name[1:])) for name, item in self.published.items()}

    def listened_of(self, diagram: Diagram, *, actions: bool = False) -> dict[str, CommandTopic]:
        """Return the topics of the built diagram that controllers subscribe to, or its actions."""
        known = self.actions if actions else self.subscribed
        return {name: replace(item, port=diagram.GetInputPort(name[1:])) for name, item in known.items()}


def ports_by_topic(ports: Mapping[str, PublishedTopic] | Mapping[str, CommandTopic]) -> dict[str, tuple[str, ...]]:
    """Return each topic with the ports that it has."""
    found: dict[str, tuple[str, ...]] = {}
    for name, item in ports.items():
        found[item.topic] = (*found.get(item.topic, ()), name)
    return found


def _port_name(item: PublishedTopic | CommandTopic, known: Mapping[str, object]) -> str:
    """Return a port's name that is free: the topic's, or for a further port one with its owner."""
    owned = f"{item.topic}@{item.robot}/{item.controller}"
    names = chain((item.topic, owned), (f"{owned}/{number}" for number in count(2)))
    return next(name for name in names if name not in known)


def _refuse_other_type(known: PublishedTopic | CommandTopic, item: PublishedTopic | CommandTopic) -> None:
    if known.type != item.type:
        types = f"{known.type} for robot {known.robot!r} and {item.type} for {item.robot!r}"
        raise InputError(f"{item.topic} would have two types: {types}. Give each its own namespace")
