"""A service in Foxglove, whose server waits for each response in a thread."""

import contextlib
import threading
from collections.abc import Callable
from concurrent.futures import Future, InvalidStateError
from typing import Any

from drake_twin.wires.wire import Reply


class FoxgloveService:
    """Answers the requests of a service.

    Args:
        name: The service's name.
        answer: Is called with each request's CDR bytes and a function that takes the response's.
        ended: Is called once when the service ends.
    """

    def __init__(self, name: str, answer: Callable[[bytes, Reply], None], ended: "Callable[[FoxgloveService], None]"):
        self.name = name
        self._answer, self._ended = answer, ended
        self._waiting: set[Future[bytes]] = set()
        self._is_closed = False
        self._lock = threading.Lock()

    def handle(self, request: Any) -> bytes:
        """Wait for a request's response, in one of the server's threads."""
        response: Future[bytes] = Future()
        with self._lock:
            if self._is_closed:
                raise RuntimeError(f"{self.name} has ended")
            self._waiting.add(response)

        def reply(data: bytes) -> None:
            with contextlib.suppress(InvalidStateError):  # the service has ended meanwhile
                response.set_result(data)

        try:
            self._answer(request.payload, reply)
            return response.result()
        finally:
            with self._lock:
                self._waiting.discard(response)

    def close(self) -> None:
        """End the service; requests that wait fail, as those do whose robot is deleted."""
        with self._lock:
            was_closed, self._is_closed = self._is_closed, True
            waiting = tuple(self._waiting)
        for response in waiting:
            with contextlib.suppress(InvalidStateError):
                response.set_exception(RuntimeError(f"{self.name} has ended"))
        if not was_closed:
            self._ended(self)
