"""A ZeroMQ socket to a ``meshcat-server`` that sends ahead of the answers and detects a lost server."""

import contextlib
from collections.abc import Iterator
from typing import TYPE_CHECKING

from drake_twin.shared_viewer.meshcat_protocol import Command

if TYPE_CHECKING:
    import zmq

POLL = 20  # ms
RETRY = 200  # ms between attempts to connect
_LONGEST_RETRY = 1000  # ms
_HEARTBEAT = 1000  # ms: a machine that fails does not close its connections
_HEARTBEAT_TIMEOUT = 4000  # ms


class NoServerError(Exception):
    """The connection to a server is lost, or cannot be made."""


class MeshcatConnection:
    """A socket that sends ahead of the answers, and a monitor of its connection; a context manager that closes both.

    Args:
        context: The ZeroMQ context.
        url: The server's address.

    Attributes:
        has_failed: Whether an attempt to connect has failed.
    """

    def __init__(self, context: "zmq.Context[zmq.Socket[bytes]]", url: str):
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
        """Wait up to 20 ms; return whether the handshake with a server has succeeded."""
        self.check(POLL)
        return self._is_open

    def check(self, timeout: int = 0) -> None:
        """Process the events of the connection, waiting for at most ``timeout`` ms.

        Raises:
            NoServerError: If an open connection was lost.
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
        """Send a command and return at once; the queue is longer than the number of unanswered commands."""
        self._socket.send_multipart((b"", *command), flags=self._zmq.NOBLOCK)

    def answers(self) -> Iterator[bytes]:
        """Wait up to 20 ms for answers, and yield them.

        Raises:
            NoServerError: If the connection was lost.
        """
        if self._socket.poll(POLL):
            with contextlib.suppress(self._zmq.Again):
                while True:
                    yield self._socket.recv_multipart(flags=self._zmq.NOBLOCK)[-1]
        else:
            self.check()
