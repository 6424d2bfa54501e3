"""A mirror on the ROS 2 graph: it hears the robot's topics, and tells what it finds; it publishes nothing else.

What it publishes are ``/diagnostics`` and ``/twin/residuals``, and it offers ``/twin/check_trajectory``. A topic that a
robot listens to is never offered: the wire is not even asked for one.
"""

import queue
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from drake_twin.messages.interface_types import definition, deserialize, make, serialize, type_hash
from drake_twin.mirror.check_service import CheckService
from drake_twin.mirror.heard import Heard
from drake_twin.mirror.learner import Learner
from drake_twin.mirror.mirror import Mirror
from drake_twin.program import say
from drake_twin.wires.wire import LARGEST_OF_NODES, Sender, Wire, WireEndpoint, close_all

NODE = "/drake_twin_mirror"
DIAGNOSTICS, RESIDUALS = "/diagnostics", "/twin/residuals"
_PERIODS = {DIAGNOSTICS: 1.0, RESIDUALS: 0.1}  # s
_TYPES = {DIAGNOSTICS: "diagnostic_msgs/msg/DiagnosticArray", RESIDUALS: "std_msgs/msg/Float64MultiArray"}
_FRAME = 1 / 30  # s
_WAIT = 0.02  # s for which the next message is waited for
_MOST = 20_000  # messages that wait


class Live:
    """Joins a mirror and wires.

    Args:
        mirror: The mirror.
        wires: The wires; they are closed with this.
        learner: What learns values of the twin in the background; it is closed with this, too.
    """

    def __init__(self, mirror: Mirror, wires: Sequence[Wire], learner: Learner | None = None):
        self._learner = learner
        self._mirror, self._wires = mirror, wires
        self._queue: queue.Queue[tuple[float, str, str, bytes]] = queue.Queue(_MOST)
        self._lost = 0
        self._senders: dict[str, list[Sender]] = {
            name: [wire.advertise(_endpoint(name, kind), lambda _: None) for wire in wires]
            for name, kind in _TYPES.items()
        }
        self._checks = CheckService(mirror.twin, wires, NODE)
        self._due = dict.fromkeys(_TYPES, 0.0)
        commands = {topic: self._type_of(ours) for topic, ours in mirror.topics.commands.items()}
        for name, kind in (commands | {name: item.type for name, item in mirror.topics.measured.items()}).items():
            for wire in wires:
                wire.listen(_endpoint(name, kind), partial(self._heard, name, kind))

    def run(
        self, stopped: Sequence[int], duration: float | None = None, each_frame: Callable[[], None] = lambda: None
    ) -> None:
        """Follow the robot until a signal arrives, or for a time (s).

        Args:
            stopped: The signals that have arrived.
            duration: The time (s); None for no end.
            each_frame: Is called about 30 times a second.
        """
        begin = next_frame = time.monotonic()
        while not stopped and (duration is None or time.monotonic() - begin < duration):
            try:
                received, topic, kind, data = self._queue.get(timeout=_WAIT)
            except queue.Empty:
                self._mirror.proceed(time.monotonic())
            else:
                self._hear(received, topic, kind, data)
            now = time.monotonic()
            self.tell(now)
            self._checks.proceed()
            if self._learner is not None:
                self._learn(self._learner)
            if now >= next_frame:
                next_frame = now + _FRAME
                each_frame()

    def tell(self, now: float) -> None:
        """Publish what is due at a time (s)."""
        for name, due in self._due.items():
            if now < due:
                continue
            self._due[name] = now + _PERIODS[name]
            senders = [sender for sender in self._senders[name] if sender.is_heard]
            if senders:
                content = diagnostics(self._mirror) if name == DIAGNOSTICS else residuals(self._mirror)
                data = serialize(make(_TYPES[name], content))
                for sender in senders:
                    sender.send(data, time.time_ns())

    def close(self) -> None:
        """End the wires."""
        self._checks.close()
        if self._learner is not None:
            self._learner.close()
        close_all(self._wires)
        if self._lost:
            self._mirror.note(f"{self._lost} messages were lost: they came faster than they could be followed")

    def _heard(self, topic: str, kind: str, data: bytes) -> None:
        """Take a message, in a wire's thread."""
        try:
            self._queue.put_nowait((time.monotonic(), topic, kind, data))
        except queue.Full:
            self._lost += 1

    def _hear(self, received: float, topic: str, kind: str, data: bytes) -> None:
        try:
            message = deserialize(kind, data)
        except ValueError as error:
            self._mirror.note(f"{topic}: {error}")
            return
        heard = Heard(received, topic, kind, message)
        if self._learner is not None:
            self._learner.hear(heard)
        self._mirror.hear(heard)

    def _learn(self, learner: Learner) -> None:
        if (said := learner.outcome()) is not None:
            say(said)
        if learner.is_due:
            learner.begin(self._mirror.topics.topics)

    def _type_of(self, topic: str) -> str:
        return next(item.type for item in self._mirror.twin.graph.endpoints if item.name == topic)


def _endpoint(name: str, kind: str) -> WireEndpoint:
    return WireEndpoint(name, kind, type_hash(kind), NODE, definition=definition(kind), largest=LARGEST_OF_NODES)


def diagnostics(mirror: Mirror) -> dict[str, Any]:
    """Return the fields of a ``diagnostic_msgs/msg/DiagnosticArray``: one status for each robot."""
    now = time.time_ns()
    status = []
    for robot, level, text in (mirror.condition(robot) for robot in mirror.robots):
        own = [alarm for alarm in mirror.alarms if alarm.robot == robot]
        values = [{"key": "alarms", "value": str(len(own))}]
        values += [{"key": alarm.kind, "value": ", ".join(alarm.parts)} for alarm in own if alarm.ended is None]
        status.append(
            {"level": level, "name": f"twin: {robot}", "message": text, "hardware_id": robot, "values": values}
        )
    stamp = {"sec": now // 10**9, "nanosec": now % 10**9}
    return {"header": {"stamp": stamp}, "status": status}


def residuals(mirror: Mirror) -> dict[str, Any]:
    """Return the fields of a ``std_msgs/msg/Float64MultiArray``: how far each number is on its way to an alarm (1)."""
    levels = mirror.levels()
    dim = [{"label": name, "size": 1, "stride": 1} for name in levels]
    return {"layout": {"dim": dim, "data_offset": 0}, "data": list(levels.values())}
