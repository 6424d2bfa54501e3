"""The graph of the double."""

import itertools
import json
import os
import re
import socket
import threading
from collections import deque


class RCLError(RuntimeError):
    """As rclpy raises it."""


class UnknownROSArgsError(RuntimeError):
    """As rclpy raises it."""


class NodeNameNonExistentError(RuntimeError):
    """As rclpy raises it."""


class InvalidNodeNameException(ValueError):  # noqa: N818  # rclpy's name
    """As rclpy raises it."""


class InvalidTopicNameException(ValueError):  # noqa: N818  # rclpy's name
    """As rclpy raises it."""


class InvalidHandle(RuntimeError):  # noqa: N818  # rclpy's name
    """As rclpy raises it."""


class Context:
    """A context, whose handle is itself."""

    def __init__(self):
        self.is_valid, self.remappings, self.handle = False, {}, self


class Graph:
    """All ends of topics and services in this process, and those that a test has on the other side of a socket."""

    def __init__(self):
        self.changed = threading.Condition()
        self.nodes, self.ends, self.outside = [], [], []
        self.beside = json.loads(os.environ.get("RCLPY_DOUBLE_BESIDE", "{}"))  # nodes of others → their topics
        self._socket = None
        if address := os.environ.get("RCLPY_DOUBLE"):
            self._socket = socket.socket(socket.AF_UNIX)
            self._socket.connect(address)
            threading.Thread(target=self._read, args=(self._socket.makefile("r"),), daemon=True).start()

    def tell(self, what, **fields):
        """Tell the test."""
        if self._socket is not None:
            self._socket.sendall(json.dumps({"what": what, **fields}).encode() + b"\n")

    def close(self):
        """End the connection."""
        if self._socket is not None:
            self._socket.close()

    def of(self, kind, name):
        """Return the ends of a kind."""
        return [end for end in self.ends if end.kind == kind and end.topic == name]

    def add(self, end):
        """Add an end."""
        with self.changed:
            self.ends.append(end)
            node = f"{end.node.namespace.rstrip('/')}/{end.node.name}"
            depth, latched = (end.quality.depth, end.quality.is_latched) if end.quality else (10, False)
            told = {"name": end.topic, "type": end.type.TYPE, "node": node, "depth": depth, "latched": latched}
            if end.quality and end.quality.lifespan:
                told["lifespan"] = end.quality.lifespan.nanoseconds
            self.tell(end.kind, **told)
            self.changed.notify_all()

    def remove(self, end):
        """Remove an end."""
        with self.changed:
            self.ends.remove(end)
            self.tell(f"no {end.kind}", name=end.topic)

    def put(self, end, item):
        """Let something come to an end."""
        with self.changed:
            end.come.append(item)
            self.changed.notify_all()

    def _read(self, lines):
        for line in lines:
            told = json.loads(line)
            name, data = told.get("name"), bytes.fromhex(told.get("data", ""))
            with self.changed:
                if told["what"] in ("subscribe", "serve", "typed"):
                    self.outside.append(told)
                elif told["what"] == "leave":
                    self.outside = [each for each in self.outside if each["name"] != name]
                elif told["what"] == "publish":
                    for end in self.of("subscription", name):
                        self.put(end, padded(data))
                elif told["what"] == "ask":
                    for end in self.of("service", name):
                        self.put(end, (end.type.Request(data), Header(told["number"])))
                elif told["what"] == "answer":
                    for end in self.of("client", name):
                        self.put(end, (Header(told["number"]), end.type.Response(data)))


class Header:
    """A request's number."""

    def __init__(self, number):
        self.sequence_number, self.request_id = number, self


class Handle:
    """A handle, in whose ``with`` it is not destroyed."""

    def __init__(self, end):
        self._end, self.pointer = end, id(end)

    def __enter__(self):
        self._end.check()

    def __exit__(self, *_):
        pass

    def get_topic_name(self):
        """Return the name after remappings."""
        return self._end.topic

    def take_message(self, kind, raw):
        """Return the next message and what is known of it."""
        assert raw
        return (self._end.come.popleft(), {}) if self._end.come else None

    def service_take_request(self, kind):
        """Return the next request and its header."""
        return self._end.come.popleft() if self._end.come else (None, None)

    def take_response(self, kind):
        """Return the next response and its header."""
        return self._end.come.popleft() if self._end.come else (None, None)

    def send_request(self, request):
        """Send a request; return its number."""
        return self._end.ask(request)


class End:
    """A publisher, a subscription, a service or a client."""

    kind = ""

    def __init__(self, node, kind, name, quality=None):
        if " " in name:
            raise InvalidTopicNameException(name)
        self.node, self.type, self.quality = node, kind, quality
        self.topic = node.context.remappings.get(name, name)
        self.handle, self.come, self.is_there = Handle(self), deque(), True
        GRAPH.add(self)

    def check(self):
        """Refuse what is destroyed."""
        if not self.is_there:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")

    def destroy(self):
        """Take it off the graph."""
        self.is_there = False
        GRAPH.remove(self)


class Publisher(End):
    """A publisher."""

    kind = "publisher"

    def __init__(self, *args):
        super().__init__(*args)
        self.last = None

    def get_subscription_count(self):
        """Return how many subscriptions there are, those of this process among them."""
        there = [each for each in GRAPH.outside if each["what"] == "subscribe" and each["name"] == self.topic]
        return len(there) + len(GRAPH.of("subscription", self.topic))

    def publish(self, data):
        """Publish bytes."""
        self.check()
        if not isinstance(data, bytes):
            raise TypeError("Expected a message")
        self.last = data
        GRAPH.tell("message", name=self.topic, data=data.hex())
        for end in GRAPH.of("subscription", self.topic):
            GRAPH.put(end, padded(data))


class Subscription(End):
    """A subscription, which gets the last message of a latched publisher."""

    kind = "subscription"

    def __init__(self, *args):
        super().__init__(*args)
        for end in GRAPH.of("publisher", self.topic):
            if end.quality.is_latched and self.quality.is_latched and end.last is not None:
                GRAPH.put(self, padded(end.last))


class Service(End):
    """A service."""

    kind = "service"

    def send_response(self, response, header):
        """Send a response."""
        self.check()
        assert isinstance(response, self.type.Response)
        GRAPH.tell("response", name=self.topic, number=header.sequence_number, data=response.data.hex())
        for end in GRAPH.of("client", self.topic):
            GRAPH.put(end, (header, response))


class Client(End):
    """A client."""

    kind = "client"
    numbers = itertools.count(1)

    def service_is_ready(self):
        """Return whether the service is there."""
        there = [each for each in GRAPH.outside if each["what"] == "serve" and each["name"] == self.topic]
        return bool(there or GRAPH.of("service", self.topic))

    def ask(self, request):
        """Send a request; return its number."""
        assert isinstance(request, self.type.Request)
        number = next(self.numbers)
        GRAPH.tell("request", name=self.topic, number=number, data=request.data.hex())
        for end in GRAPH.of("service", self.topic):
            GRAPH.put(end, (request, Header(number)))
        return number


class Node:
    """A node, which publishes the events of its parameters, and its log."""

    def __init__(self, name, namespace, context, *, enable_rosout):
        assert context.is_valid
        if not re.fullmatch(r"\w+", name):
            raise InvalidNodeNameException(name)
        self.name, self.namespace, self.context = name, namespace, context
        GRAPH.nodes.append(self)
        self._events = Publisher(self, _EVENT, "/parameter_events")
        if enable_rosout:
            self._log = Publisher(self, _LOG, "/rosout")

    def destroy_node(self):
        """Take it and its ends off the graph."""
        for end in [end for end in GRAPH.ends if end.node is self]:
            end.destroy()
        GRAPH.nodes.remove(self)

    def create_publisher(self, kind, name, quality):
        """Return a new publisher."""
        return Publisher(self, kind, name, quality)

    def create_subscription(self, kind, name, callback, quality, *, raw):
        """Return a new subscription."""
        assert raw
        return Subscription(self, kind, name, quality)

    def create_service(self, kind, name, callback, *, qos_profile):
        """Return a new service."""
        return Service(self, kind, name, qos_profile)

    def create_client(self, kind, name):
        """Return a new client."""
        return Client(self, kind, name)

    def destroy_publisher(self, end):
        """Take an end off the graph."""
        end.destroy()

    destroy_subscription = destroy_service = destroy_client = destroy_publisher

    def get_node_names_and_namespaces(self):
        """Return all nodes."""
        others = [(name.rpartition("/")[2], name.rpartition("/")[0] or "/") for name in GRAPH.beside]
        return [*((node.name, node.namespace) for node in GRAPH.nodes), *others]

    def get_publisher_names_and_types_by_node(self, name, namespace):
        """Return a node's publishers."""
        if (name, namespace) not in self.get_node_names_and_namespaces():
            raise NodeNameNonExistentError(name)
        beside = GRAPH.beside.get(f"{namespace.rstrip('/')}/{name}", ())
        ends = [end for end in GRAPH.ends if (end.kind, end.node.name) == ("publisher", name)]
        return [*((topic, ["?"]) for topic in beside), *((end.topic, [end.type.TYPE]) for end in ends)]

    def get_topic_names_and_types(self):
        """Return all topics."""
        return self._names_and_types("publisher", "subscription")

    def get_service_names_and_types(self):
        """Return all services."""
        return self._names_and_types("service", "client")

    def _names_and_types(self, *kinds):
        found = {}
        for end in GRAPH.ends:
            if end.kind in kinds:
                found.setdefault(end.topic, {})[end.type.TYPE] = None
        for each in GRAPH.outside:
            if each["what"] == "typed":
                found.setdefault(each["name"], {})[each["type"]] = None
        return [(name, list(types)) for name, types in found.items()]


class _EVENT:
    TYPE = "rcl_interfaces/msg/ParameterEvent"


class _LOG:
    TYPE = "rcl_interfaces/msg/Log"


def padded(data):
    """Return a message as CycloneDDS hands it on: filled up to four bytes."""
    return data + bytes(-len(data) % 4)


GRAPH = Graph()
