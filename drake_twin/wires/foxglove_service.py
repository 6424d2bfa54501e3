"""A service in Foxglove, whose server waits for each response in a thread."""

import contextlib
import json
import threading
from collections.abc import Callable
from concurrent.futures import Future, InvalidStateError
from typing import TYPE_CHECKING, Any

from drake_twin.messages.interface_types import definition, deserialize, serialize
from drake_twin.messages.json_messages import from_json, json_data, json_schema
from drake_twin.wires.wire import LARGEST, Reply

if TYPE_CHECKING:
    from foxglove.websocket import MessageSchema, Service

CDR, JSON = "cdr", "json"  # encodings


class FoxgloveService:
    """Answers the requests of a service.

    Args:
        name: The service's name.
        kind: Its type.
        encoding: That of its requests and responses: ``cdr`` or ``json``.
        answer: Is called with each request's CDR bytes and a function that takes the response's.
        ended: Is called once when the service ends.
    """

    def __init__(
        self,
        name: str,
        kind: str,
        encoding: str,
        answer: Callable[[bytes, Reply], None],
        ended: "Callable[[FoxgloveService], None]",
    ):
        self.name, self._kind, self._encoding = name, kind, encoding
        self._answer, self._ended = answer, ended
        self._waiting: set[Future[bytes]] = set()
        self._is_closed = False
        self._lock = threading.Lock()

    def offer(self) -> "Service":
        """Return the service as the SDK has it."""
        from foxglove.websocket import Service, ServiceSchema

        parts = ServiceSchema(self._kind, request=self._schema("Request"), response=self._schema("Response"))
        return Service(self.name, schema=parts, handler=self.handle)

    def _schema(self, part: str) -> "MessageSchema":
        from foxglove import Schema
        from foxglove.websocket import MessageSchema

        name = f"{self._kind}_{part}"
        if self._encoding == CDR:
            schema = Schema(name=name, encoding="ros2msg", data=definition(name).encode())
        else:
            schema = Schema(name=name, encoding="jsonschema", data=json.dumps(json_schema(name)).encode())
        return MessageSchema(encoding=self._encoding, schema=schema)

    def handle(self, request: Any) -> bytes:
        """Wait for a request's response, in one of the server's threads.

        Raises:
            RuntimeError: If the service ends.
            ValueError: If the request is not one of the service.
        """
        if self._encoding == CDR:
            return self._ask(request.payload)
        if len(request.payload) > LARGEST:
            raise ValueError(f"a request of more than {LARGEST} bytes is refused")
        asked = serialize(from_json(f"{self._kind}_Request", request.payload))
        return json_data(deserialize(f"{self._kind}_Response", self._ask(asked)))

    def _ask(self, request: bytes) -> bytes:
        response: Future[bytes] = Future()
        with self._lock:
            if self._is_closed:
                raise RuntimeError(f"{self.name} has ended")
            self._waiting.add(response)

        def reply(data: bytes) -> None:
            with contextlib.suppress(InvalidStateError):  # the service has ended meanwhile
                response.set_result(data)

        try:
            self._answer(request, reply)
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
