"""The door before Foxglove's server, which takes web sockets of any page: it looks at ``Host`` and ``Origin`` first.

A browser names the page that opens a web socket in ``Origin``, and other programs name none. The SDK's server does not
look at it, and cannot be told to. So it listens at a random address of the loopback network, which a page cannot find,
and this door at the address that is announced. It copies bytes, in Linux within the kernel.
"""

import contextlib
import logging
import os
import re
import secrets
import socket
import sys
import threading
from collections.abc import Iterable

from drake_twin.own_host import is_loopback, is_own_name, split_host
from drake_twin.wires.log_once import LogOnce

_log = logging.getLogger(__name__)

# Foxglove in the browser, and its desktop application, whose page is a file: a browser names the origin of a file null.
ORIGINS = ("https://app.foxglove.dev", "https://studio.foxglove.dev", "file://")
MOST_CLIENTS = 64
_LONGEST_HEAD = 16384  # bytes of a request
_LONGEST_WAIT = 5.0  # s of wall time for it
_CHUNK = 1 << 16  # bytes
_MOST_LINES = 20  # of the log
_ORIGIN = re.compile(r"[\w.+-]+://[\w.:\[\]-]*")


def hidden_address() -> str:
    """Return an address at which to listen that nobody knows; where the system has but one of its own, that one."""
    if sys.platform != "linux":
        return "127.0.0.1"
    return "127.{}.{}.{}".format(*(1 + secrets.randbelow(254) for _ in range(3)))


def is_origin(text: str) -> bool:
    """Tell whether a text can be an origin: a scheme, a host and, where it is not the usual one, a port."""
    return _ORIGIN.fullmatch(text) is not None


class FoxgloveDoor:
    """Listens at an address, and connects those who may pass with a server.

    Args:
        host: The address to listen on.
        port: The port; 0 for any free one.
        origins: The origins of pages that may pass, beside `ORIGINS`.

    Attributes:
        port: The port.

    Raises:
        OSError: If the port cannot be opened.
    """

    def __init__(self, host: str, port: int, origins: Iterable[str] = ()):
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        self._listening = socket.create_server((host, port), family=family)
        self.port: int = self._listening.getsockname()[1]
        self._host = host
        self._origins = frozenset({*ORIGINS, *origins})
        self._open: set[socket.socket] = set()
        self._threads: set[threading.Thread] = set()
        self._lock = threading.Lock()
        self._log = LogOnce(_log, "foxglove: a connection is refused", _MOST_LINES)
        self._accepting = threading.Thread(target=self._accept, name="foxglove door", daemon=True)

    def lead_to(self, address: tuple[str, int]) -> None:
        """Connect clients from now on with the server at an address."""
        self._server = address
        self._accepting.start()

    def close(self) -> None:
        """End all connections."""
        with contextlib.suppress(OSError):
            self._listening.shutdown(socket.SHUT_RDWR)  # wakes `accept`
        self._listening.close()
        with self._lock:
            sockets, threads = tuple(self._open), tuple(self._threads)
        for each in sockets:
            _shut(each)
        for thread in threads:
            thread.join(_LONGEST_WAIT)
        if self._accepting.ident is not None:
            self._accepting.join(_LONGEST_WAIT)

    def refusal(self, head: bytes) -> str | None:
        """Return why a request is refused; None if it may pass.

        Args:
            head: The request's line and headers.
        """
        fields = [line.partition(b":") for line in head.split(b"\r\n")[1:]]
        given = [(name.strip().lower(), value.strip().decode("latin-1")) for name, _, value in fields]
        for host in (value for name, value in given if name == b"host"):
            name, _ = split_host(host)
            if is_loopback(self._host) and not (is_loopback(name) or is_own_name(name, self._host)):
                return f"the Host header names {host[:100]!r}, and this server is localhost"
        for origin in (value for name, value in given if name == b"origin"):
            if origin not in self._origins:
                return f"a page of {origin[:100]!r} may not open it: --foxglove-origin names pages that may"
        return None

    def _accept(self) -> None:
        while True:
            try:
                client, _ = self._listening.accept()
            except OSError:
                return
            with self._lock:
                is_full = len(self._threads) >= MOST_CLIENTS
                if not is_full:
                    thread = threading.Thread(target=self._pass, args=(client,), name="foxglove client", daemon=True)
                    self._threads.add(thread)
                    self._open.add(client)
            if is_full:
                self._log(f"more than {MOST_CLIENTS} connections at the same time")
                client.close()
            else:
                thread.start()

    def _pass(self, client: socket.socket) -> None:
        try:
            with contextlib.suppress(OSError), client:
                client.settimeout(_LONGEST_WAIT)
                head = _head_of(client)
                if head is None:
                    return
                refusal = self.refusal(head)
                if refusal is not None:
                    self._log(refusal)
                    text = f"refused: {refusal}\n".encode("latin-1", "replace")
                    client.sendall(b"HTTP/1.1 403 Forbidden\r\nContent-Type: text/plain\r\nConnection: close\r\n")
                    client.sendall(b"Content-Length: %d\r\n\r\n" % len(text) + text)
                    return
                self._connect(client, head)
        finally:
            with self._lock:
                self._open.discard(client)
                self._threads.discard(threading.current_thread())

    def _connect(self, client: socket.socket, head: bytes) -> None:
        with socket.create_connection(self._server, _LONGEST_WAIT) as server:
            for each in (client, server):
                each.settimeout(None)
                each.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            server.sendall(head)
            back = threading.Thread(target=_copy, args=(server, client), name="foxglove client", daemon=True)
            back.start()
            _copy(client, server)
            back.join()


def _head_of(client: socket.socket) -> bytes | None:
    """Return what a client sends up to the end of its request's headers, and more; None if that does not come."""
    head = b""
    while b"\r\n\r\n" not in head:
        data = client.recv(_LONGEST_HEAD)
        head += data
        if not data or len(head) > _LONGEST_HEAD:
            return None
    return head


def _copy(source: socket.socket, target: socket.socket) -> None:
    """Copy what arrives until one of the two ends, and end both."""
    with contextlib.suppress(OSError):
        if hasattr(os, "splice"):
            _splice(source.fileno(), target.fileno())
        else:
            while data := source.recv(_CHUNK):
                target.sendall(data)
    _shut(source)
    _shut(target)


def _splice(source: int, target: int) -> None:
    """Copy in the kernel, so that the interpreter is free meanwhile."""
    end, begin = os.pipe()
    try:
        while count := os.splice(source, begin, _CHUNK):
            while count:
                count -= os.splice(end, target, count)
    finally:
        os.close(end)
        os.close(begin)


def _shut(each: socket.socket) -> None:
    with contextlib.suppress(OSError):
        each.shutdown(socket.SHUT_RDWR)
