"""What is commanded of the controllers: messages that wait, that hold, that expire, and that the scenario schedules."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, is_dataclass
from math import isfinite
from operator import attrgetter
from typing import Any

from pydrake.common.value import Value
from pydrake.systems.framework import Context

from drake_twin.controllers.controller import Controller
from drake_twin.diagram.topics import CommandTopic
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.messages import Numbers, shortened
from drake_twin.scenario import Command
from drake_twin.twin.plain_data import from_plain, to_plain
from drake_twin.twin.robot_control import RobotControl
from drake_twin.twin.schedule import ScheduledCommand, step_at
from drake_twin.twin.snapshot import Snapshot

_ROUNDING = 1e-9  # s
_published = attrgetter("published")
_ObjectValue = Value[object]  # what AbstractValue.Make would look up each time


@dataclass(frozen=True)
class _Before:
    """What `Commands.apply` is about to change."""

    values: dict[str, Any]
    expiries: dict[str, float]
    queue: list[tuple[str, Any]]
    published: list[int]


class Commands:
    """The values on the ports of topics and actions.

    Attributes:
        values: topic or action → the value that holds.
        expiries: topic → when its value no longer holds (s).
        schedule: the scenario's own commands.
        silenced: topics whose scheduled commands are dropped.
    """

    def __init__(self) -> None:
        self.values: dict[str, Any] = {}
        self.expiries: dict[str, float] = {}
        self.schedule: list[ScheduledCommand] = []
        self.silenced: set[str] = set()
        self._queue: list[tuple[str, Any]] = []
        self._ports: dict[str, CommandTopic] = {}
        self._before: _Before | None = None

    def use(self, built: TwinDiagram, context: Context, controls: Mapping[str, RobotControl], time_step: float) -> None:
        """Works with a diagram from now on; what its topics do not have is forgotten."""
        self._ports = built.commanded | built.actions
        self._context = context
        self._controls = controls
        self._time_step = time_step
        self.values = {topic: value for topic, value in self.values.items() if topic in self._ports}
        self.expiries = {topic: time for topic, time in self.expiries.items() if topic in self._ports}
        self.schedule = [item for item in self.schedule if item.topic in self._ports]
        self._queue = [entry for entry in self._queue if entry[0] in self._ports]
        for topic, value in self.values.items():
            self._fix(topic, value)

    def start(self, commands: Sequence[Command]) -> None:
        """Begins anew: nothing holds, nothing waits, and a scenario's commands are ahead."""
        self.values.clear()
        self.expiries.clear()
        self._queue.clear()
        self.schedule = [ScheduledCommand(command) for command in commands]

    def wait(self, topic: str, value: Any) -> None:
        """Lets a value wait for the next step."""
        self._queue.append((topic, value))

    def waiting(self, topic: str) -> Iterator[Any]:
        """What waits for a topic, in the order of arrival."""
        return (value for queued_topic, value in self._queue if queued_topic == topic)

    def put_waiting(self, time: float, action: CommandTopic | None = None) -> None:
        """Puts what waits onto its ports, or only what waits for an action's controller, so that it precedes a goal.

        Args:
            time: the present time (s).
            action: the action.
        """
        waiting, self._queue = self._queue, []
        for topic, value in waiting:
            item = self._ports[topic]
            if action is None or (item.robot, item.controller) == (action.robot, action.controller):
                self.set(topic, value, time)
            else:
                self._queue.append((topic, value))

    def apply(self, step: int, time: float, publish: Callable[[ScheduledCommand], None]) -> None:
        """Puts onto the ports what is due at a step: what expires, what is scheduled, what waits.

        Args:
            step: the present step.
            time: the present time (s).
            publish: does with a scheduled command what is done with one that somebody publishes.
        """
        self._before = None
        if not (self.schedule or self.expiries or self._queue):
            return
        published = list(map(_published, self.schedule))
        self._before = _Before(dict(self.values), dict(self.expiries), self._queue, published)
        due = []
        for scheduled in self.schedule:
            if scheduled.due_step(self._time_step) <= step:
                if scheduled.topic not in self.silenced:
                    due.append(scheduled)
                scheduled.pass_step()
        for topic in [topic for topic, until in self.expiries.items() if until <= time + _ROUNDING]:
            self.set(topic, None, time)
        waiting, self._queue = self._queue, []
        for scheduled in due:
            publish(scheduled)
        self._queue += waiting
        self.put_waiting(time)

    def take_back(self) -> None:
        """Undoes what `apply` did last: the step that was to follow has failed."""
        if self._before is None:
            return
        for topic in self._ports:
            if self.values.get(topic) is not self._before.values.get(topic):
                self._fix(topic, self._before.values.get(topic))
        self.values, self.expiries, self._queue = self._before.values, self._before.expiries, self._before.queue
        for item, published in zip(self.schedule, self._before.published, strict=True):
            item.published = published
        self._before = None

    def set(self, topic: str, value: Any, time: float) -> None:
        """Puts a value onto a port at a time (s); None clears it."""
        before, item = self.values.get(topic), self._ports[topic]
        control = self._controls[item.robot]
        controller = control.controllers[item.controller]
        self._put(topic, value, time, controller)
        if controller.starts_or_stops(before, value):
            control.follow_commands()

    def _put(self, topic: str, value: Any, time: float, controller: Controller) -> None:
        self._fix(topic, value)
        self.values.pop(topic, None)
        self.expiries.pop(topic, None)
        if value is None:
            return
        self.values[topic] = value
        timeout = controller.timeout(self._ports[topic].name)
        if timeout is not None and isfinite(timeout):
            self.expiries[topic] = time + max(timeout, self._time_step)

    def clear(self, robot: str, controller: str) -> None:
        """Forgets what was commanded of a controller."""
        own = {name for name, item in self._ports.items() if (item.robot, item.controller) == (robot, controller)}
        self._queue = [entry for entry in self._queue if entry[0] not in own]
        for name in own:
            self._fix(name, None)
            self.values.pop(name, None)
            self.expiries.pop(name, None)

    def due_steps(self) -> list[float]:
        """The steps at which something is due."""
        due = [item.due_step(self._time_step) for item in self.schedule]
        return due + [step_at(time, self._time_step) for time in self.expiries.values()]

    def snapshot(self) -> dict[str, Any]:
        """The entries of a `Snapshot` that are commands."""
        return {
            "commands": {topic: to_plain(value) for topic, value in self.values.items()},
            "expiries": dict(self.expiries),
            "waiting": [[topic, to_plain(value)] for topic, value in self._queue],
            "schedule": [item.published for item in self.schedule],
            "silenced": sorted(self.silenced & {item.topic for item in self.schedule}),
        }

    def restore(self, snapshot: Snapshot, time: float) -> None:
        """Goes back from the start to the commands of a snapshot at a time (s).

        Raises:
            ValueError: they are those of other robots.
            KeyError: likewise.
        """
        for topic, value in snapshot.commands.items():
            saved, port = self._saved(topic, value), self._ports[topic]
            self._put(topic, saved, time, self._controls[port.robot].controllers[port.controller])
        if not set(snapshot.expiries) <= set(snapshot.commands):
            raise ValueError("what expires is not commanded")
        self.expiries = dict(snapshot.expiries)
        for topic, value in snapshot.waiting:
            self.wait(topic, self._saved(topic, value))
        for item, published in zip(self.schedule, snapshot.schedule, strict=True):
            item.published = published
        self.silenced = set(snapshot.silenced)

    def _saved(self, topic: str, plain: Any) -> Any:
        """A command of a snapshot."""
        item = self._ports[topic]
        value = from_plain(plain)
        kind = getattr(value, "__msgtype__", None)
        subscribed = self._controls[item.robot].controllers[item.controller].subscribed.get(item.name, kind)
        if not is_dataclass(value) or (kind is not None and kind != subscribed):
            raise ValueError(f"{shortened(plain)} is no message of {topic}")
        if isinstance(value, Numbers) or kind == "std_msgs/msg/Float64MultiArray":
            control = self._controls[item.robot]
            return control.controllers[item.controller].read(item.name, value, control.context_of(item.controller))
        return value

    def _fix(self, topic: str, value: Any) -> None:
        self._ports[topic].port.FixValue(self._context, _ObjectValue(value))
