"""A wire of another package: once it fails it carries nothing, and the twin and the other wires continue."""

from collections.abc import Callable
from typing import Any

from drake_twin.twin.others_code import OthersCode
from drake_twin.wires.wire import Nothing, Reply, Wire, WireEndpoint


class OthersWire:
    """Guards the calls of a wire; see `Wire`.

    Args:
        wire: The wire.
        code: What has opened it.
    """

    def __init__(self, wire: Wire, code: OthersCode):
        self._wire, self._code = wire, code
        if hasattr(wire, "client"):  # else it is not one that asks
            self.client: Callable[..., Any] = lambda *arguments: self._end(wire.client, *arguments)

    def advertise(self, topic: WireEndpoint, listened: Callable[[bool], None]) -> Any:
        """Offer a topic."""
        return self._end(self._wire.advertise, topic, listened)

    def listen(self, topic: WireEndpoint, heard: Callable[[bytes], None]) -> Any:
        """Hear a topic."""
        return self._end(self._wire.listen, topic, heard)

    def serve(self, service: WireEndpoint, answer: Callable[[bytes, Reply], None]) -> Any:
        """Offer a service."""
        return self._end(self._wire.serve, service, answer)

    def close(self) -> None:
        """End the wire."""
        self._code.run(self._wire.close)

    def _end(self, make: Callable[..., Any], *arguments: Any) -> Any:
        end = self._code.run(make, *arguments)
        return Nothing() if self._code.fault else _OthersEnd(end, self._code)


class _OthersEnd:
    """Guards a sender, a client, or what can be ended."""

    def __init__(self, end: Any, code: OthersCode):
        self._end, self._code = end, code

    @property
    def is_heard(self) -> bool:
        return self._code.fault is None and bool(getattr(self._end, "is_heard", False))

    @property
    def is_there(self) -> bool:
        return self._code.fault is None and bool(getattr(self._end, "is_there", False))

    def send(self, data: bytes, time: int) -> None:
        self._call("send", data, time)

    def ask(self, request: bytes, answered: Reply) -> None:
        self._call("ask", request, answered)

    def close(self) -> None:
        self._call("close")

    def _call(self, name: str, *arguments: Any) -> None:
        self._code.run(lambda: getattr(self._end, name)(*arguments))
