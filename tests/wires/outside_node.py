"""A node of another program on a wire; it handles what comes as an executor does. For doubles of Nav2 and MoveIt."""

import itertools
import os
import queue
import sys
import time
from collections import deque
from collections.abc import Callable
from typing import Any

from waiting import LONGEST

from drake_twin.messages.interface_types import deserialize, make, serialize, type_hash
from drake_twin.wires.wire import WireEndpoint

ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(1, 7)  # action_msgs/msg/GoalStatus


def wire_of(kind: str, domain: int) -> Any:
    """Open the wire of this kind, "dds" or "rclpy"."""
    if kind == "dds":
        from drake_twin.wires.dds_wire import DdsWire

        return DdsWire(domain)
    from drake_twin.wires.rclpy_wire import RclpyWire

    return RclpyWire(domain)


def seconds(stamp: Any) -> float:
    return stamp.sec + stamp.nanosec * 1e-9


def stamp_of(time: float) -> dict[str, int]:
    nanoseconds = round(time * 1e9)
    return {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}


class OutsideNode:
    """A node with the simulation's time; all callbacks come in the thread that spins it.

    Args:
        name: Its name.
        arguments: Of the program: the kind of wire and its domain.

    Attributes:
        time: The time on ``/clock`` (s); 0 before the first.
    """

    def __init__(self, name: str, arguments: list[str]):
        self._wire = wire_of(arguments[0], int(arguments[1]))
        self._name = name
        self._events: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self.time = 0.0
        self.listen("/clock", "rosgraph_msgs/msg/Clock", self._set_time, is_best_effort=True, depth=1)

    def _set_time(self, message: Any) -> None:
        self.time = seconds(message.clock)

    def _end(self, name: str, kind: str, **options: Any) -> WireEndpoint:
        return WireEndpoint(name, kind, type_hash(kind), f"/{self._name}", **options)

    def listen(self, topic: str, kind: str, heard: Callable[[Any], None], **options: Any) -> None:
        """Hear a topic; of what waits, as much is kept as its depth says."""
        end = self._end(topic, kind, **options)
        waiting: deque[bytes] = deque(maxlen=end.kept)

        def take() -> None:
            if waiting:
                heard(deserialize(kind, waiting.popleft()))

        def put(data: bytes) -> None:
            waiting.append(data)
            self._events.put(take)

        self._wire.listen(end, put)

    def publisher(self, topic: str, kind: str, is_heard: bool = True) -> Callable[[dict[str, Any]], None]:
        """Return what publishes on a topic; wait for who hears it, unless nobody will."""
        sender = self._wire.advertise(self._end(topic, kind), lambda is_heard: None)
        self.spin(lambda: sender.is_heard or not is_heard)

        def publish(fields: dict[str, Any]) -> None:
            sender.send(serialize(make(kind, fields)), 0)
            getattr(sender, "flush", lambda: None)()

        return publish

    def service(self, name: str, kind: str) -> "OutsideClient":
        return OutsideClient(self, self._wire.client(self._end(name, kind), lambda: None), kind)

    def later(self, work: Callable[[], None]) -> None:
        self._events.put(work)

    def spin(self, is_done: Callable[[], Any]) -> None:
        """Handle what comes until something is so."""
        end = time.monotonic() + LONGEST
        while not is_done():
            assert time.monotonic() < end, "it did not come about"
            try:
                self._events.get(timeout=0.05)()
            except queue.Empty:
                continue

    def wait_until(self, time: float) -> None:
        """Handle what comes until a time of the simulation (s)."""
        self.spin(lambda: self.time >= time)

    def close(self) -> None:
        self._wire.close()


class OutsideClient:
    """A client of a service."""

    def __init__(self, node: OutsideNode, client: Any, kind: str):
        self._node, self._client, self._kind = node, client, kind

    def call(self, fields: dict[str, Any]) -> Any:
        """Wait for the service, and for its response."""
        self._node.spin(lambda: self._client.is_there)
        found: list[Any] = []
        self.ask(fields, found.append)
        self._node.spin(lambda: found)
        return found[0]

    def ask(self, fields: dict[str, Any], answered: Callable[[Any], None]) -> None:
        def put(data: bytes) -> None:
            self._node.later(lambda: answered(deserialize(f"{self._kind}_Response", data)))

        self._client.ask(serialize(make(f"{self._kind}_Request", fields)), put)


class OutsideAction:
    """A client of an action, with the services and topics that rclcpp_action's has."""

    _numbers = itertools.count(1)

    def __init__(self, node: OutsideNode, name: str, kind: str):
        self.node = node
        base = f"{name}/_action"
        self._send = node.service(f"{base}/send_goal", f"{kind}_SendGoal")
        self._result = node.service(f"{base}/get_result", f"{kind}_GetResult")
        self._cancel = node.service(f"{base}/cancel_goal", "action_msgs/srv/CancelGoal")
        self._goals: dict[bytes, OutsideGoal] = {}
        node.listen(f"{base}/feedback", f"{kind}_FeedbackMessage", self._hear_feedback)
        node.listen(f"{base}/status", "action_msgs/msg/GoalStatusArray", self._hear_status, latched=True)

    def _hear_feedback(self, message: Any) -> None:
        if (goal := self._goals.get(bytes(message.goal_id.uuid))) is not None:
            goal.feedback.append((self.node.time, message.feedback))

    def _hear_status(self, message: Any) -> None:
        for status in message.status_list:
            if (goal := self._goals.get(bytes(status.goal_info.goal_id.uuid))) is not None:
                goal.statuses.append(int(status.status))

    def send(self, goal: dict[str, Any]) -> "OutsideGoal":
        """Send a goal; wait whether it is accepted."""
        uuid = os.getpid().to_bytes(8) + next(self._numbers).to_bytes(8)
        known = self._goals[uuid] = OutsideGoal(self, uuid)
        known.accepted = bool(self._send.call({"goal_id": {"uuid": list(uuid)}, "goal": goal}).accepted)
        return known

    def result(self, goal: "OutsideGoal") -> Any:
        return self._result.call({"goal_id": {"uuid": list(goal.uuid)}})

    def cancel(self, goal: "OutsideGoal") -> Any:
        return self._cancel.call({"goal_info": {"goal_id": {"uuid": list(goal.uuid)}}})


class OutsideGoal:
    """A goal that was sent: whether it was accepted, its feedback with the time, its statuses."""

    def __init__(self, action: OutsideAction, uuid: bytes):
        self.action, self.uuid = action, uuid
        self.accepted = False
        self.feedback: list[tuple[float, Any]] = []
        self.statuses: list[int] = []

    def result(self) -> tuple[int, Any]:
        """Wait for the result; return the status and it."""
        response = self.action.result(self)
        return int(response.status), response.result

    def cancel(self) -> int:
        """Ask to cancel it; return how many goals are canceled."""
        return len(self.action.cancel(self).goals_canceling)


def run(program: Callable[[OutsideNode], Any]) -> None:
    """Run a program on the wire that its arguments name, and print what it found as JSON."""
    import json

    node = OutsideNode(program.__name__, sys.argv[1:])
    try:
        print(json.dumps(program(node), default=lambda number: number.item()))  # those of NumPy
    finally:
        node.close()
