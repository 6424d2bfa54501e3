"""The service ``/twin/check_trajectory``: what would happen if the robot were sent a trajectory, before it moves.

Its type is ``drake_twin_msgs/srv/CheckTrajectory``, which ``docs/mirror.md`` has as a file.
"""

from collections.abc import Generator, Sequence
from queue import Empty, SimpleQueue
from typing import Any

from drake_twin.errors import TwinError
from drake_twin.messages.interface_types import deserialize, make_response, serialize, type_hash
from drake_twin.messages.text import plain_data
from drake_twin.mirror.look_ahead import answer_later
from drake_twin.twin.twin import Twin
from drake_twin.wires.wire import LARGEST, Closable, Reply, Wire, WireEndpoint

NAME, TYPE = "/twin/check_trajectory", "drake_twin_msgs/srv/CheckTrajectory"
_MOST = 16  # requests that wait


class CheckService:
    """Answers the service over wires.

    Args:
        twin: The twin that follows the robot.
        wires: The wires.
        node: The full name of the node that has the service.
    """

    def __init__(self, twin: Twin, wires: Sequence[Wire], node: str):
        self._twin = twin
        self._asked: SimpleQueue[tuple[bytes, Reply]] = SimpleQueue()
        self._pending: list[tuple[Generator[None, None, dict[str, Any]], Reply]] = []
        endpoint = WireEndpoint(NAME, TYPE, type_hash(TYPE), node)
        self._served: list[Closable] = [wire.serve(endpoint, self._ask) for wire in wires]

    def proceed(self) -> None:
        """Begin what was asked, and answer what is done; in the thread that has the twin."""
        while len(self._pending) < _MOST:
            try:
                data, reply = self._asked.get_nowait()
            except Empty:
                break
            self._begin(data, reply)
        for pending in list(self._pending):
            answer, reply = pending
            try:
                next(answer)
            except StopIteration as stop:
                self._pending.remove(pending)
                self._reply(reply, response(stop.value))
            except TwinError as error:
                self._pending.remove(pending)
                self._reply(reply, {"is_safe": False}, str(error))

    def close(self) -> None:
        """Answer nothing any more."""
        for served in self._served:
            served.close()

    def _ask(self, data: bytes, reply: Reply) -> None:
        """Take a request, in a thread of a wire."""
        self._asked.put((data, reply))

    def _begin(self, data: bytes, reply: Reply) -> None:
        try:
            if len(data) > LARGEST:
                raise ValueError(f"a request of more than {LARGEST} bytes is ignored")
            request = deserialize(f"{TYPE}_Request", data)
        except ValueError as error:
            self._reply(reply, {"is_safe": False}, str(error))
            return
        trajectory = plain_data(request.trajectory)
        self._pending.append((answer_later(self._twin, request.topic, trajectory, request.duration or None), reply))

    @staticmethod
    def _reply(reply: Reply, fields: dict[str, Any], reason: str = "") -> None:
        reply(serialize(make_response(TYPE, fields, reason)))


def response(verdict: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of a response to a verdict's."""
    problems = verdict["problems"]
    return {
        "is_safe": verdict["is_safe"],
        "ended": verdict["ended"],
        "times": [item["time"] for item in problems],
        "kinds": [item["kind"] for item in problems],
        "parts": [", ".join(item["parts"]) for item in problems],
        "texts": [item["text"] for item in problems],
    }
