"""A client on the ROS 2 graph over Zenoh: it sees who is there, and calls services."""

import itertools
import queue
import time
from typing import Any

from drake_twin.errors import InputError, RunError
from drake_twin.wires.rmw_zenoh_format import (
    CLIENT,
    NO_HASH,
    GraphEntity,
    Qos,
    attachment,
    read_token,
    topic_key,
)
from drake_twin.wires.wire import WireEndpoint
from drake_twin.wires.zenoh_session import ROUTER_PORT
from drake_twin.wires.zenoh_wire import ZenohWire

_LOOK = 0.1  # s between two looks for a signal while a service has not answered


class ZenohClient(ZenohWire):
    """A Zenoh session that connects to a router and is never one itself.

    Args:
        router: The router's address, ``HOST`` or ``HOST:PORT``.
        domain: The ROS domain; ``ROS_DOMAIN_ID`` by default.

    Raises:
        InputError: If Zenoh is not installed, the domain is invalid, or no router answers.
    """

    def __init__(self, router: str = f"127.0.0.1:{ROUTER_PORT}", domain: int | None = None):
        super().__init__(domain=domain, router=router)
        self._numbers = itertools.count(1)

    def entities(self) -> list[GraphEntity]:
        """Return the nodes and endpoints of the domain."""
        entities = (read_token(token) for token in self.tokens(self.domain))
        return [entity for entity in entities if entity is not None]

    def domains(self) -> list[int]:
        """Return the domains in which there is a node."""
        numbers = {token.split("/")[1] for token in self.tokens("*")}
        return sorted(int(number) for number in numbers if number.isdigit())

    def call(self, service: WireEndpoint, request: bytes, timeout: float) -> bytes:
        """Call a service and return its response.

        Args:
            service: The service.
            request: The request's CDR bytes.
            timeout: How long to wait for the response (s).

        Raises:
            InputError: If the service does not accept the request.
            RunError: If it does not answer.
        """
        from zenoh import handlers

        key = topic_key(self.domain, service.name, service.type, service.hash or NO_HASH)
        replies: queue.SimpleQueue[Any] = queue.SimpleQueue()
        source, leave = self._graph.add(CLIENT, service, Qos())
        try:
            self._session.get(
                key,
                handlers.Callback(replies.put, lambda: replies.put(None), indirect=False),
                payload=request,
                attachment=attachment(next(self._numbers), time.time_ns(), source),
                timeout=timeout,
            )
            reply = _next(replies)
        finally:
            leave()
        if reply is None:
            raise RunError(f"{service.name} does not answer")
        if reply.ok is None:
            raise InputError(f"{service.name}: {reply.err.payload.to_bytes().decode(errors='replace')}")
        return bytes(reply.ok.payload.to_bytes())


def _next(replies: "queue.SimpleQueue[Any]") -> Any:
    """Wait for a reply so that signals are handled; None if it does not come."""
    while True:
        try:
            return replies.get(timeout=_LOOK)
        except queue.Empty:
            continue
