"""Records on the pipes between the twin and the process of the machine's ROS 2.

Each is a kind, an endpoint's number, a request's number and the length of what follows: a message in CDR, or JSON.
"""

import contextlib
import json
import struct
import threading
from collections.abc import Iterator
from typing import Any, BinaryIO

_HEAD = struct.Struct("<cIqI")
# To the process: an endpoint comes or goes, another program's topics are asked for; a message, a response, a request.
OPEN, CLOSE, BESIDE, MESSAGE, RESPONSE, REQUEST = b"O", b"C", b"B", b"M", b"R", b"Q"
# From it, besides: it has started or could not, anybody listens or a service is there, problems.
STARTED, FAILED, HEARD, PROBLEMS = b"S", b"F", b"H", b"P"
_MOST_PENDING = 1 << 16  # bytes


class Pipe:
    """Writes records whole, from any thread; those to a process that has ended are lost.

    Args:
        file: What is written to, without a buffer.
    """

    def __init__(self, file: BinaryIO):
        self._file, self._lock, self._pending = file, threading.Lock(), bytearray()

    def write(self, kind: bytes, endpoint: int = 0, number: int = 0, content: bytes = b"") -> None:
        """Write a record, and those that wait."""
        with self._lock:
            self._add(kind, endpoint, number, content)
            self._write()

    def write_later(self, kind: bytes, endpoint: int, number: int, content: bytes) -> None:
        """Write a record with the next one, or at the next `flush`, so that the reader wakes up once for many."""
        with self._lock:
            self._add(kind, endpoint, number, content)
            if len(self._pending) > _MOST_PENDING:
                self._write()

    def flush(self) -> None:
        """Write the records that wait."""
        with self._lock:
            self._write()

    def tell(self, kind: bytes, content: Any) -> None:
        """Write a record of JSON."""
        self.write(kind, content=json.dumps(content).encode())

    def close(self) -> None:
        """End the pipe."""
        with self._lock, contextlib.suppress(OSError):
            self._write()
            self._file.close()

    def _add(self, kind: bytes, endpoint: int, number: int, content: bytes) -> None:
        self._pending += _HEAD.pack(kind, endpoint, number, len(content))
        self._pending += content

    def _write(self) -> None:
        data, self._pending = memoryview(self._pending), bytearray()
        with contextlib.suppress(OSError, ValueError):
            while data:
                data = data[self._file.write(data) :]


def records(source: BinaryIO) -> Iterator[tuple[bytes, int, int, bytes]]:
    """Yield the records of a pipe until it ends: their kinds, endpoints, requests and contents."""
    while len(head := source.read(_HEAD.size)) == _HEAD.size:
        kind, endpoint, number, length = _HEAD.unpack(head)
        content = source.read(length)
        if len(content) == length:
            yield kind, endpoint, number, content
