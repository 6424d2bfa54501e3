"""A client of the wire's own server, which lets the server publish the values of parameters.

The SDK's ``publish_parameter_values`` waits for a lock with Python's interpreter locked, and the server holds that lock
where it tells Python who subscribes: both would wait for ever (measured with 0.30.3: in seconds of subscribing and
publishing). What a client's request to set parameters returns is published without the interpreter.
"""

import contextlib
import socket
import threading
from collections.abc import Sequence
from typing import TYPE_CHECKING
from uuid import uuid4

if TYPE_CHECKING:
    from foxglove.websocket import Parameter

_LONGEST = 2.0  # s of wall time
_KEY = "AAAAAAAAAAAAAAAAAAAAAA=="  # of the handshake: any 16 bytes
_CHUNK = 65536
_CLOSE = bytes((0x88, 0x80, 0, 0, 0, 0))  # the frame that ends a connection


class FoxgloveOwnClient:
    """Asks the server for each publication, in a connection of its own: parameters seldom change.

    Attributes:
        request: The id of its requests, which no other client knows.
    """

    def __init__(self) -> None:
        self.request = uuid4().hex
        self._waiting: list[Parameter] = []
        self._lock = threading.Lock()

    def publish(self, parameters: "Sequence[Parameter]", host: str, port: int) -> None:
        """Let the server at an address publish parameters to those who subscribe to them."""
        with self._lock:
            self._waiting += parameters
        with contextlib.suppress(OSError), socket.create_connection((host, port), _LONGEST) as own:  # it has ended
            own.sendall(
                f"GET / HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: foxglove.sdk.v1\r\n"
                f"Sec-WebSocket-Key: {_KEY}\r\n\r\n".encode()
            )
            _read_until(own, b"\r\n\r\n")
            own.sendall(_text_frame(f'{{"op":"setParameters","parameters":[],"id":"{self.request}"}}') + _CLOSE)
            _read_until(own)

    def take(self) -> "list[Parameter]":
        """Return what is to be published, in the thread of the server that its request has reached."""
        with self._lock:
            waiting, self._waiting = self._waiting, []
        return waiting


def _text_frame(text: str) -> bytes:
    """Return a short text as a client's frame (RFC 6455), masked with zeros."""
    data = text.encode()
    return bytes((0x81, 0x80 | len(data), 0, 0, 0, 0)) + data


def _read_until(connection: socket.socket, end: bytes | None = None) -> None:
    """Read until some bytes come, or until the server closes the connection."""
    tail = b""
    while (end is None or end not in tail) and (data := connection.recv(_CHUNK)):
        tail = tail[-3:] + data
