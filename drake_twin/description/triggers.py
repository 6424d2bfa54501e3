"""What publishes and calls services when it hears a message, as gz-sim's TriggeredPublisher does, as plain data."""

from collections.abc import Iterator, Mapping
from dataclasses import field
from typing import Any, Protocol

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_plugins import CannotWorkError, PluginReader, plugin_node_name
from drake_twin.description.gz_messages import (
    GZ_TYPES,
    Leaf,
    UnknownMessageError,
    field_leaves,
    gz_type,
    message_leaves,
    ros_fields,
)
from drake_twin.description.gz_requests import GzRequest, UnknownRequestError, read_request
from drake_twin.description.plugin_element import PluginElement
from drake_twin.description.touches import EnableTouch, TouchDetector
from drake_twin.findings import Place
from drake_twin.values import parse_number

ANY_TYPE = ""
_TOLERANCE = 1e-8
_LOGIC = ("positive", "negative")


class Condition(Protocol):
    """A condition on a message."""

    def holds(self, message: Any) -> bool:
        """Tell whether it holds for a ROS message."""
        ...


@dataclass(frozen=True)
class Match:
    """What a message has, or has not, in some fields.

    Attributes:
        leaves: The fields that are compared.
        tolerance: The largest difference of numbers with a point.
        is_positive: Whether it holds where all of them fit; else where one does not.
    """

    leaves: tuple[Leaf, ...]
    tolerance: float = _TOLERANCE
    is_positive: bool = True

    def holds(self, message: Any) -> bool:
        """Tell whether it holds for a ROS message."""
        return self.is_positive == all(leaf.fits(message, self.tolerance) for leaf in self.leaves)


@dataclass(frozen=True)
class TriggeredMessage:
    """A message that is published: its topic, its ROS type and its fields that are not zero."""

    topic: str
    type: str
    fields: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class TriggeredRequest:
    """A service that is called.

    Attributes:
        service: Its name.
        world: The name of the world in that.
        request: The request; None where the twin has no such service.
        problem: Why it has none; empty if it has.
    """

    service: str
    world: str = ""
    request: GzRequest | None = None
    problem: str = ""


@dataclass(frozen=True)
class Trigger:
    """What waits for a message.

    Attributes:
        name: The plugin's name.
        topic: The topic that it hears, with a leading slash: gz's, or after planning that of ROS.
        type: Its ROS type; `ANY_TYPE` for any.
        matches: The conditions; all have to hold.
        delay: The time until it publishes (s).
        messages: What it publishes then.
        requests: The services that it calls then, after that.
        place: Where it was written.
    """

    name: str
    topic: str
    type: str
    matches: tuple[Condition, ...] = ()
    delay: float = 0.0
    messages: tuple[TriggeredMessage, ...] = ()
    requests: tuple[TriggeredRequest, ...] = ()
    place: Place = field(default=Place(""), compare=False)

    def hears(self, message: Any) -> bool:
        """Tell whether a ROS message of its type triggers it."""
        return all(match.holds(message) for match in self.matches)


def read_trigger(plugin: PluginReader) -> Trigger:
    """Read ``gz-sim-triggered-publisher-system``.

    Raises:
        CannotWorkError: If it has no input or does nothing, or has a type or a field that the twin does not know.
        InputError: If a value is invalid; with file and line.
    """
    for tag in ("input", "input/match", "output", "service"):
        plugin.has(tag)
    tree = plugin.plugin.tree
    source = next((item for item in tree if item.tag == "input"), None)
    outputs = [item for item in tree if item.tag == "output"]
    if source is None:
        raise CannotWorkError("<input> is missing")
    services = [item for item in tree if item.tag == "service"]
    if not outputs and not services:
        raise CannotWorkError("it does nothing: <output> or <service> is missing")
    delay = plugin.number("delay_ms", 0.0)
    try:
        kind = gz_type(_attribute(source, "type"))
        matches = [_match(plugin, kind, item) for item in source.inside if item.tag == "match" and item.text]
        if not matches and any(item.tag == "match" for item in source.inside):
            raise CannotWorkError("its <match> is empty")
        messages = tuple(_message(plugin, item) for item in outputs)
        requests = tuple(_request(plugin, item) for item in services)
    except UnknownMessageError as error:
        raise CannotWorkError(str(error)) from None
    return Trigger(
        name=plugin_node_name(plugin.plugin),
        topic=_topic(source),
        type=GZ_TYPES[kind].ros,
        matches=tuple(matches),
        delay=max(delay, 0.0) / 1000.0,
        messages=messages,
        requests=requests,
        place=plugin.plugin.place,
    )


def enabling_triggers(detector: TouchDetector, topic: str) -> Iterator[Trigger]:
    """Yield what lets a detector of touches look, or no longer look, as a message says; gz-sim has a service for it.

    Args:
        detector: The detector.
        topic: Its namespace of topics in gz's transport.
    """
    for is_enabled in (True, False):
        request = TriggeredRequest(f"{topic}/enable", request=EnableTouch(topic, is_enabled))
        is_meant = Match((Leaf(("data",), is_enabled),))
        kind = GZ_TYPES["Boolean"].ros
        yield Trigger(detector.name, f"{topic}/enable", kind, (is_meant,), requests=(request,), place=detector.place)


def _attribute(element: PluginElement, name: str) -> str:
    value = element.attributes.get(name, "").strip()
    if not value:
        raise CannotWorkError(f"<{element.tag}> has no {name}")
    return value


def _topic(element: PluginElement) -> str:
    return f"/{_attribute(element, 'topic').strip('/')}"


def _match(plugin: PluginReader, kind: str, element: PluginElement) -> Match:
    logic = element.attributes.get("logic_type", _LOGIC[0])
    if logic not in _LOGIC:
        raise plugin.error(f"logic_type of <match> is {logic!r}, which is neither 'positive' nor 'negative'")
    given = element.attributes.get("tol", "")
    try:
        tolerance = parse_number(given) if given else _TOLERANCE
    except ValueError as error:
        raise plugin.error(f"tol of <match> is {given!r}, which is {error}") from None
    if tolerance < 0.0:
        raise plugin.error(f"tol of <match> is {given!r}, and has to be zero or more")
    name = element.attributes.get("field")
    try:
        leaves = message_leaves(kind, element.text) if name is None else field_leaves(kind, name, element.text)
    except ValueError as error:
        raise plugin.error(f"<match> is {element.text!r}: {error}") from None
    return Match(leaves, tolerance, logic == _LOGIC[0])


def _message(plugin: PluginReader, element: PluginElement) -> TriggeredMessage:
    kind = gz_type(_attribute(element, "type"))
    try:
        fields = ros_fields(kind, element.text)
    except ValueError as error:
        raise plugin.error(f"<output> is {element.text!r}: {error}") from None
    return TriggeredMessage(_topic(element), GZ_TYPES[kind].ros, fields)


def _request(plugin: PluginReader, element: PluginElement) -> TriggeredRequest:
    name = _attribute(element, "name")
    kind, text = _attribute(element, "reqType"), _attribute(element, "reqMsg")
    for each in ("repType", "timeout"):
        _attribute(element, each)
    try:
        world, request = read_request(name, kind, text)
    except UnknownRequestError as error:
        return TriggeredRequest(name, problem=str(error))
    except ValueError as error:
        raise plugin.error(f"reqMsg of <service> is {text!r}: {error}") from None
    return TriggeredRequest(name, world, request)
