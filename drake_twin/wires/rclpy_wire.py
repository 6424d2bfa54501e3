"""The ROS 2 graph through the rclpy of the ROS 2 that is installed on the machine: its middleware, its discovery."""

import itertools
import json
import logging
from collections.abc import Callable, Sequence
from functools import partial
from queue import Empty, SimpleQueue

from drake_twin.findings import first_of
from drake_twin.messages.field_types import field_types
from drake_twin.wires.rclpy_process import RosProcess
from drake_twin.wires.rclpy_records import BESIDE, CLOSE, HEARD, MESSAGE, OPEN, PROBLEMS, REQUEST, RESPONSE
from drake_twin.wires.ros_names import domain_of_environment, is_name
from drake_twin.wires.wire import Closable, Nothing, Reply, Sender, ServiceClient, WireEndpoint

_log = logging.getLogger(__name__)
_PATIENCE = 5.0  # s of wall time for an answer of the process
_NAMED = 5  # topics in a message


class RclpyWire:
    """The twin's nodes as nodes of the machine's ROS 2.

    Args:
        domain: The ROS domain; ``ROS_DOMAIN_ID`` by default.
        arguments: Arguments of ROS, with ``--ros-args``.

    Attributes:
        domain: The ROS domain.
        place: What runs the nodes, in words.
        pipe: Where the process is told.
        write: Writes a record there.

    Raises:
        InputError: If no ROS 2 is sourced, or it does not start.
    """

    def __init__(self, domain: int | None = None, arguments: Sequence[str] = ()):
        self._ends: dict[int, _End] = {}
        self._numbers = itertools.count(1)
        self._beside: SimpleQueue[list[str]] = SimpleQueue()
        self.domain = domain_of_environment() if domain is None else domain
        self._process = RosProcess(arguments, self.domain, self._take, self._note_end)
        self.write, self.pipe = self._process.pipe.write, self._process.pipe
        started = self._process.started
        distribution = f"ROS 2 {started['distribution']}".strip()
        self.place = f"{distribution} of this machine (rclpy, {started['middleware']}), with {self._process.python}"

    def advertise(self, topic: WireEndpoint, listened: Callable[[bool], None]) -> Sender:
        """Offer a topic; see `drake_twin.wires.wire.Wire`."""
        end = _Sender(self, topic, listened)
        return end if self._open("publisher", topic, end, topic.type) else Nothing()

    def listen(self, topic: WireEndpoint, heard: Callable[[bytes], None]) -> Closable:
        """Hear a topic; see `drake_twin.wires.wire.Wire`."""
        end = _Listener(self, topic, heard)
        return end if self._open("subscription", topic, end, topic.type) else Nothing()

    def serve(self, service: WireEndpoint, answer: Callable[[bytes, Reply], None]) -> Closable:
        """Offer a service; see `drake_twin.wires.wire.Wire`."""
        end = _Server(self, service, answer)
        return end if self._open("service", service, end, *_of_service(service)) else Nothing()

    def client(self, service: WireEndpoint, changed: Callable[[], None]) -> ServiceClient:
        """Look for a service of another program; see `drake_twin.wires.wire.AskingWire`."""
        end = _Client(self, service, changed)
        return end if self._open("client", service, end, *_of_service(service)) else Nothing()

    def topics_beside(self, node: str) -> Sequence[str]:
        """Return the topics of another program's node; see `drake_twin.wires.other_twins`."""
        self.write(BESIDE, content=node.encode())
        try:
            return self._beside.get(timeout=_PATIENCE)
        except Empty:
            return ()

    def close(self) -> None:
        """End the nodes."""
        self._process.close()

    def forget(self, number: int) -> None:
        """Take an endpoint off the graph."""
        if self._ends.pop(number, None) is not None:
            self.write(CLOSE, number)

    def _open(self, what: str, endpoint: WireEndpoint, end: "_End", *types: str) -> bool:
        """Put an endpoint on the graph; return whether it can be, and log if not."""
        if not is_name(endpoint.name) or not is_name(endpoint.node):
            _log.warning("%s of %s is not on the graph: it is not a name of ROS", endpoint.name, endpoint.node)
            return False
        try:
            fields = {name: fields for kind in types for name, fields in field_types(kind).items()}
        except ValueError as error:
            _log.warning("%s is not on the graph: %s", endpoint.name, error)
            return False
        end.number = next(self._numbers)
        self._ends[end.number] = end
        told = {
            "what": what,
            "name": endpoint.name,
            "type": endpoint.type,
            "node": endpoint.node,
            "latched": endpoint.latched,
            "best_effort": endpoint.is_best_effort,
            "depth": endpoint.kept,
            "lifespan": endpoint.lifespan,
            "keeps_all": endpoint.keeps_all,
            "deadline": endpoint.deadline,
            "is_manual": endpoint.is_manual,
            "lease": endpoint.lease,
            "fields": fields,
        }
        self.write(OPEN, end.number, content=json.dumps(told).encode())
        return True

    def _take(self, kind: bytes, end: int, number: int, content: bytes) -> None:
        """Hand on what has come, in the process's thread."""
        if kind == PROBLEMS:
            self._log_problems(json.loads(content))
        elif kind == BESIDE:
            self._beside.put(json.loads(content))
        elif (found := self._ends.get(end)) is not None:
            found.take(kind, number, content)

    def _log_problems(self, problems: list[tuple[str, str, list[str]]]) -> None:
        """Log what is wrong with which topics and services; all packages that are missing in one line."""
        missing = {package: names for _, package, names in problems if package}
        for text, package, names in problems:
            if not package:
                _log.warning("%s: %s", first_of(names, _NAMED), text)
        if missing:
            listed = "; ".join(f"of {package} {first_of(names, _NAMED)}" for package, names in missing.items())
            name = self._process.started["distribution"] or "DISTRO"
            packages = " ".join(f"ros-{name}-{package.replace('_', '-')}" for package in missing)
            what = "or build them in the workspace that is sourced"
            _log.warning(
                "not on the graph, for this ROS 2 lacks packages: %s (`sudo apt install %s`, %s)",
                listed,
                packages,
                what,
            )

    def _note_end(self, words: str) -> None:
        """Take note that the process has ended, in its thread."""
        for end in tuple(self._ends.values()):
            end.take(HEARD, 0, b"")
        _log.warning("the twin is no longer on the graph of ROS 2, and the simulation continues: %s", words)


def _of_service(service: WireEndpoint) -> tuple[str, str]:
    return f"{service.type}_Request", f"{service.type}_Response"


class _End:
    """An endpoint in the process.

    Attributes:
        number: Its number.
        topic: What it belongs to.
    """

    number = 0

    def __init__(self, wire: RclpyWire, topic: WireEndpoint):
        self.topic, self._wire = topic, wire

    def take(self, kind: bytes, number: int, content: bytes) -> None:
        """Take a record, in the process's thread."""

    def close(self) -> None:
        """Take it off the graph."""
        self._wire.forget(self.number)


class _Sender(_End):
    """Sends the messages of a topic.

    Attributes:
        is_heard: Whether anybody listens; always true for a topic whose messages are kept for late joiners.
        flush: Sends the pending messages of all topics.
    """

    def __init__(self, wire: RclpyWire, topic: WireEndpoint, listened: Callable[[bool], None]):
        super().__init__(wire, topic)
        self.flush = wire.pipe.flush
        self.is_heard = topic.latched
        self._listened = listened

    def send(self, data: bytes, at: int) -> None:
        """Send a message with the next ones."""
        self._wire.pipe.write_later(MESSAGE, self.number, 0, data)

    def take(self, kind: bytes, number: int, content: bytes) -> None:
        if self.is_heard != bool(number):
            self.is_heard = bool(number)
            self._listened(self.is_heard)


class _Listener(_End):
    """Hears the messages of a topic."""

    def __init__(self, wire: RclpyWire, topic: WireEndpoint, heard: Callable[[bytes], None]):
        super().__init__(wire, topic)
        self._heard = heard

    def take(self, kind: bytes, number: int, content: bytes) -> None:
        if kind == MESSAGE:
            self._heard(content)


class _Server(_End):
    """Answers the requests of a service."""

    def __init__(self, wire: RclpyWire, service: WireEndpoint, answer: Callable[[bytes, Reply], None]):
        super().__init__(wire, service)
        self._answer = answer

    def take(self, kind: bytes, number: int, content: bytes) -> None:
        if kind == REQUEST:
            self._answer(content, partial(self._wire.write, RESPONSE, self.number, number))


class _Client(_End):
    """Asks a service of another program.

    Attributes:
        is_there: Whether the service is there.
    """

    def __init__(self, wire: RclpyWire, service: WireEndpoint, changed: Callable[[], None]):
        super().__init__(wire, service)
        self.is_there, self._changed = False, changed
        self._requests = itertools.count(1)
        self._asked: dict[int, Reply] = {}

    def ask(self, request: bytes, answered: Reply) -> None:
        """Send a request."""
        number = next(self._requests)
        self._asked[number] = answered
        self._wire.write(REQUEST, self.number, number, request)

    def take(self, kind: bytes, number: int, content: bytes) -> None:
        if kind == RESPONSE:
            if (answered := self._asked.pop(number, None)) is not None:
                answered(content)
        elif self.is_there != bool(number):
            self.is_there = bool(number)
            if not self.is_there:
                self._asked.clear()  # nobody answers them
            self._changed()
