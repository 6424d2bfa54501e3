"""The twin's nodes in a context of rclpy, in the process of the machine's ROS 2."""

import json
import os
import threading
import time
from collections.abc import Sequence
from typing import Any, BinaryIO

from drake_twin.wires.rclpy_classes import UnusableTypeError
from drake_twin.wires.rclpy_endpoints import ENDPOINTS, Endpoint, Subscription
from drake_twin.wires.rclpy_records import BESIDE, CLOSE, OPEN, PROBLEMS, Pipe, records
from drake_twin.wires.rclpy_waiter import Waiter

_PERIOD = 0.02  # s between two looks at who listens
_LONG_PERIOD = 1.0  # s between two looks at the types of others, and in which participants find one another
_SETTLED = 1.0  # s without a new endpoint, after which problems are told together


class RclpyGraph:
    """The twin's nodes and their endpoints.

    One thread does what the twin tells, two wait for what comes, and one looks who else is there.

    Args:
        pipe: Where the twin is told.
        arguments: The arguments of ROS, with ``--ros-args``.
        domain: The ROS domain.

    Attributes:
        pipe: Where the twin is told.
        lock: The lock of the endpoints.
    """

    def __init__(self, pipe: Pipe, arguments: Sequence[str], domain: int):
        import rclpy

        self._rclpy = rclpy
        self._context = rclpy.Context()
        rclpy.init(args=["drake_twin", *arguments], context=self._context, domain_id=domain)
        self.pipe, self.lock = pipe, threading.RLock()
        self._nodes: dict[str, Any] = {}
        self._used: dict[str, int] = {}  # a node's name → how many endpoints it has
        self._ends: dict[int, Endpoint] = {}
        self._heard: dict[str, list[Subscription]] = {}
        self._problems: dict[tuple[str, str], list[str]] = {}  # text and package that is missing → topics and services
        self._told: set[tuple[str, str]] = set()
        self._opened = time.monotonic()
        self._discovered = self._opened + _LONG_PERIOD
        self._is_over = threading.Event()
        self._look_out = self._new_node(f"/_drake_twin_{os.getpid()}")  # a hidden one; without any, nothing is open
        topics = Waiter(self._context, self.lock, ("subscription",), self._destroy, self._failed)
        services = Waiter(self._context, self.lock, ("client", "service"), self._destroy, self._failed)
        self._waiters = {"subscription": topics, "client": services, "service": services}

    def started(self) -> dict[str, Any]:
        """Return what the twin says at its start."""
        return {
            "distribution": os.environ.get("ROS_DISTRO", ""),
            "middleware": self._rclpy.get_rmw_implementation_identifier(),
        }

    def own_subscriptions(self, name: str) -> Sequence[Subscription]:
        """Return the twin's subscriptions of a topic."""
        return self._heard.get(name, ())

    def node(self, name: str) -> Any:
        """Return the node of a full name for another endpoint; with the lock."""
        if name not in self._nodes:
            self._nodes[name] = self._new_node(name)
        self._used[name] = self._used.get(name, 0) + 1
        return self._nodes[name]

    def _new_node(self, name: str) -> Any:
        """Return a new node, without the services that the twin has itself, or has not.

        Each but the hidden one has a publisher of ``/rosout``, as in ROS.
        """
        namespace, _, own = name.rpartition("/")
        parameter = self._rclpy.Parameter("start_type_description_service", value=False)
        return self._rclpy.create_node(
            own,
            namespace=namespace or "/",
            context=self._context,
            enable_rosout=not own.startswith("_"),
            start_parameter_services=False,
            parameter_overrides=[parameter],
        )

    # What the twin tells ---------------------------------------------------------------------------------------------

    def read(self, source: BinaryIO) -> None:
        """Do what records say until they end."""
        for kind, endpoint, number, content in records(source):
            try:
                self._do(kind, endpoint, number, content)
            except Exception as error:
                end = self._ends.get(endpoint)
                self._note(error, "a record" if end is None else end.name)
        self._is_over.set()

    def _do(self, kind: bytes, endpoint: int, number: int, content: bytes) -> None:
        if kind == OPEN:
            self._open(endpoint, json.loads(content))
        elif kind == CLOSE:
            self._close(endpoint)
        elif kind == BESIDE:
            self.pipe.tell(BESIDE, self._topics_beside(content.decode()))
        elif (end := self._ends.get(endpoint)) is not None:  # there was no problem with it
            end.send(number, content)

    def _open(self, number: int, told: dict[str, Any]) -> None:
        with self.lock:
            try:
                self._ends[number] = end = ENDPOINTS[told["what"]](self, number, told)
                if isinstance(end, Subscription):
                    self._heard.setdefault(end.name, []).append(end)
                if end.what in self._waiters:
                    self._waiters[end.what].add(end)
            except Exception as error:
                self._note(error, told["name"])
            self._opened = time.monotonic()

    def _close(self, number: int) -> None:
        with self.lock:
            end = self._ends.pop(number, None)
            if end is None:
                return
            if isinstance(end, Subscription):
                self._heard[end.name].remove(end)
            if end.what in self._waiters:
                self._waiters[end.what].remove(end)
            else:
                self._destroy(end)

    def _destroy(self, end: Endpoint) -> None:
        """Destroy an endpoint for which nobody waits, and its node if that was its last; with the lock."""
        getattr(end.node, f"destroy_{end.what}")(end.of)
        name = end.told["node"]
        self._used[name] -= 1
        if not self._used[name]:
            self._nodes.pop(name).destroy_node()

    # Who else is there -----------------------------------------------------------------------------------------------

    def run(self) -> None:
        """Tell the twin who listens, until it has ended."""
        next_long_look = 0.0
        while not self._is_over.wait(_PERIOD):
            now = time.monotonic()
            with self.lock:
                for end in self._ends.values():
                    end.look()
                if now >= next_long_look:
                    next_long_look = now + _LONG_PERIOD
                    self._compare_types()
                if now > self._opened + _SETTLED:
                    self._tell_problems()
        self._tell_problems()
        for waiter in set(self._waiters.values()):
            waiter.close()
        for node in (*self._nodes.values(), self._look_out):
            node.destroy_node()
        self._rclpy.shutdown(context=self._context)

    def _topics_beside(self, name: str) -> list[str]:
        """Return the topics that another program's node publishes; asked before there is one of this name here."""
        namespace, _, own = name.rpartition("/")
        place = own, namespace or "/"
        while True:
            is_last = time.monotonic() > self._discovered
            is_there = place in self._look_out.get_node_names_and_namespaces()
            if is_there and (found := self._look_out.get_publisher_names_and_types_by_node(*place)):
                return sorted(topic for topic, _ in found)
            if is_last:
                return []
            time.sleep(_PERIOD)

    def _compare_types(self) -> None:
        """Note which topics and services of others have the names of the twin's, but other types."""
        look = self._look_out
        topics, services = dict(look.get_topic_names_and_types()), dict(look.get_service_names_and_types())
        for end in self._ends.values():
            own = end.told["type"]
            for kind in (topics if end.what in ("publisher", "subscription") else services).get(end.name, ()):
                if kind != own:
                    text = f"another program has it as {kind}, but its type is {own}"
                    self._note(UnusableTypeError(text), end.name)

    def _failed(self, end: Endpoint, error: Exception) -> None:
        self._note(error, end.name)

    def _note(self, error: Exception, name: str) -> None:
        """Take note of a problem of a topic or service, once, to tell it together with others."""
        is_known = isinstance(error, UnusableTypeError)
        text = " ".join((str(error) if is_known else f"{type(error).__name__}: {error}").split())
        with self.lock:
            if (name, text) not in self._told:
                self._told.add((name, text))
                self._problems.setdefault((text, getattr(error, "package", "")), []).append(name)

    def _tell_problems(self) -> None:
        if self._problems:
            self.pipe.tell(PROBLEMS, [[*problem, names] for problem, names in self._problems.items()])
            self._problems = {}
