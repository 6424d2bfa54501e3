"""Servers and clients of services over Zenoh, as rmw_zenoh_cpp has them."""

import contextlib
import itertools
import logging
import threading
import time
from collections.abc import Callable
from typing import Any, Protocol

from drake_twin.wires.log_once import LogOnce
from drake_twin.wires.rmw_zenoh_format import (
    CLIENT,
    NO_HASH,
    SERVICE,
    Qos,
    attachment,
    read_attachment,
    servers_key,
    topic_key,
)
from drake_twin.wires.wire import Reply, WireEndpoint

_log = logging.getLogger(__name__)
_TIMEOUT = 1e6  # s; rmw_zenoh waits for ever, and Zenoh by itself for 10 s
_MOST_TOKENS = 1000  # that come between two looks


class ServingGraph(Protocol):
    """What a server or a client needs of its session's tokens."""

    domain: int

    def add(self, kind: str, endpoint: WireEndpoint, qos: Qos) -> tuple[bytes, Callable[[], None]]:
        """Put an endpoint on the graph; return its gid, and a function that takes it off."""


class ZenohServer:
    """Answers the requests of a service.

    Args:
        session: The session.
        graph: Its tokens.
        service: The service.
        answer: As in `drake_twin.wires.wire.Wire.serve`.
    """

    def __init__(
        self,
        session: Any,
        graph: ServingGraph,
        service: WireEndpoint,
        answer: Callable[[bytes, Reply], None],
    ):
        from zenoh import handlers

        self._name, self._answer = service.name, answer
        self._key = topic_key(graph.domain, service.name, service.type, service.hash or NO_HASH)
        call = handlers.Callback(self._take, indirect=False)
        self._queryable = session.declare_queryable(self._key, call, complete=True)
        _, self._leave = graph.add(SERVICE, service, Qos())

    def close(self) -> None:
        """Take it off the graph."""
        self._leave()
        self._queryable.undeclare()

    def _take(self, query: Any) -> None:
        try:
            sequence, _, client = read_attachment(b"" if query.attachment is None else query.attachment.to_bytes())
            request = b"" if query.payload is None else query.payload.to_bytes()
        except ValueError as error:
            _log.warning("%s: a request is ignored: %s", self._name, error)
            query.reply_err(str(error))
            query.drop()
            return

        def reply(data: bytes) -> None:
            with contextlib.suppress(Exception):
                query.reply(self._key, data, attachment=attachment(sequence, time.time_ns(), client))
                query.drop()

        self._answer(request, reply)


class ZenohClient:
    """Asks a service of another program.

    Args:
        session: The session.
        graph: Its tokens.
        service: The service, with the node that asks it.
        changed: Is called when the service comes and goes.
        closed: Is called when the client is closed.

    Attributes:
        is_there: Whether the service is there.
    """

    def __init__(
        self,
        session: Any,
        graph: ServingGraph,
        service: WireEndpoint,
        changed: Callable[[], None],
        closed: "Callable[[ZenohClient], None]",
    ):
        from zenoh import handlers

        self.is_there = False
        self._session, self._name, self._changed, self._closed = session, service.name, changed, closed
        self._key = topic_key(graph.domain, service.name, service.type, service.hash or NO_HASH)
        self._numbers = itertools.count(1)
        self._asked: dict[int, Reply] = {}
        self._tell = LogOnce(_log, service.name)
        self._lock = threading.Lock()
        self._servers: set[str] = set()
        key = servers_key(graph.domain, service.name, service.type)
        channel: Any = handlers.FifoChannel(_MOST_TOKENS)
        self._tokens: Any = session.liveliness().declare_subscriber(key, channel, history=True)
        self._gid, self._leave = graph.add(CLIENT, service, Qos())

    def ask(self, request: bytes, answered: Reply) -> None:
        """Send a request."""
        import zenoh
        from zenoh import handlers

        number = next(self._numbers)
        self._asked[number] = answered
        try:
            self._session.get(
                self._key,
                handlers.Callback(self._take, indirect=False),
                target=zenoh.QueryTarget.ALL_COMPLETE,
                consolidation=zenoh.ConsolidationMode.NONE,
                timeout=_TIMEOUT,
                payload=request,
                attachment=attachment(number, time.time_ns(), self._gid),
            )
        except zenoh.ZError as error:
            del self._asked[number]
            _log.warning("%s: a request is lost: %s", self._name, error)

    def look(self) -> None:
        """Look whether the service is there."""
        import zenoh

        with self._lock:
            while self._tokens is not None and (sample := self._tokens.try_recv()) is not None:
                token = str(sample.key_expr)
                (self._servers.add if sample.kind == zenoh.SampleKind.PUT else self._servers.discard)(token)
            is_there = bool(self._servers)
        if is_there != self.is_there:
            self.is_there = is_there
            if not is_there:
                self._asked.clear()  # nobody answers them
            self._changed()

    def close(self) -> None:
        """Take it off the graph."""
        self._closed(self)
        self._leave()
        with self._lock:
            if self._tokens is not None:
                self._tokens.undeclare()
                self._tokens = None
                self._servers.clear()
                self._asked.clear()
        self.is_there = False

    def _take(self, reply: Any) -> None:
        """Hand on a response; of several servers' the first, as rmw_zenoh does."""
        if reply.ok is None:
            self._tell(f"a request is refused: {reply.err.payload.to_string()}")
            return
        sent = reply.ok.attachment
        try:
            number, _, client = read_attachment(b"" if sent is None else sent.to_bytes())
        except ValueError as error:
            self._tell(f"a response is ignored: {error}")
            return
        if client == self._gid and (answered := self._asked.pop(number, None)) is not None:
            answered(reply.ok.payload.to_bytes())
