"""A ZeroMQ socket to a ``meshcat-server`` that sends ahead of the answers and notices when the server goes."""

import contextlib
from collections.abc import Iterator
from typing import Any

from drake_twin.shared_viewer.meshcat_protocol import Command

POLL = 20  # ms
RETRY = 200  # ms between attempts to connect
_LONGEST_RETRY = 1000  # ms
_HEARTBEAT = 1000  # ms: a machine that vanished says no goodbye
_HEARTBEAT_TIMEOUT = 4000  # ms


class NoServerError(Exception):
    """The connection broke."""


class MeshcatConnection:
    """A socket that sends ahead of the answers, with a watch on the connection below it.

    Args:
        context: the ``zmq.Context``.
        url: the server's address.
    """

    def __init__(self, context: Any, url: str):
        import zmq

        self._zmq = zmq
        self._socket = context.socket(zmq.DEALER)
        self._socket.linger = 0
        self._socket.reconnect_ivl = RETRY
        self._socket.reconnect_ivl_max = _LONGEST_RETRY
        self._socket.heartbeat_ivl = _HEARTBEAT
        self._socket.heartbeat_timeout = _HEARTBEAT_TIMEOUT
        self._monitor = self._socket.get_monitor_socket()
        self._socket.connect(url)
        self._is_open = False
        self.has_failed = False

    def __enter__(self) -> "MeshcatConnection":
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(self._zmq.ZMQError):
            self._socket.disable_monitor()
        self._socket.close(linger=0)

    def is_open(self) -> bool:
        """Waits a moment; whether a server has shaken hands."""
        self.look_after(POLL)
        return self._is_open

    def look_after(self, timeout: int = 0) -> None:
        """Takes note of what happened to the connection, for at most ``timeout`` ms.

        Raises:
            NoServerError: an open connection broke.
        """
        from zmq.utils.monitor import recv_monitor_message

        events = self._zmq.Event
        while self._monitor.poll(timeout):
            event = recv_monitor_message(self._monitor)["event"]
            if event == events.HANDSHAKE_SUCCEEDED:
                self._is_open = True
                return
            if event == events.DISCONNECTED and self._is_open:
                raise NoServerError("the meshcat-server is gone")
            self.has_failed |= event in (events.CONNECT_RETRIED, events.DISCONNECTED)
            timeout = 0

    def send(self, command: Command) -> None:
        """Sends without waiting; there are never enough messages on the way to fill the queue."""
        self._socket.send_multipart((b"", *command), flags=self._zmq.NOBLOCK)

    def answers(self) -> Iterator[bytes]:
        """Waits a moment for answers, and yields those that are there.

        Raises:
            NoServerError: the connection broke.
        """
        if self._socket.poll(POLL):
            with contextlib.suppress(self._zmq.Again):
                while True:
                    yield self._socket.recv_multipart(flags=self._zmq.NOBLOCK)[-1]
        else:
            self.look_after()
