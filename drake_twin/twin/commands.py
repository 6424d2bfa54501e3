"""The commands of the controllers: pending, valid, expiring, and those that the scenario schedules."""

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import is_dataclass
from math import isfinite
from operator import attrgetter
from typing import Any

from pydrake.systems.framework import Context, FixedInputPortValue

from drake_twin.controllers.base_controller import Controller
from drake_twin.dataclass import dataclass
from drake_twin.diagram.topics import CommandTopic
from drake_twin.errors import CommandError
from drake_twin.messages import Numbers, shortened
from drake_twin.scenario import Command
from drake_twin.systems.no_message import NO_MESSAGE, empty_value, set_value
from drake_twin.twin.clock import Clock
from drake_twin.twin.physics import Physics
from drake_twin.twin.plain_data import from_plain, to_plain
from drake_twin.twin.robot_control import RobotControl
from drake_twin.twin.schedule import ScheduledCommand, step_at

_log = logging.getLogger(__name__)

_ROUNDING = 1e-9  # s
_MOST_PENDING = 1000  # values, before older ones of the same topics are dropped
_published = attrgetter("published")


@dataclass(frozen=True)
class _Before:
    """What `Commands.apply` is about to change."""

    values: dict[str, Any]
    expiries: dict[str, float]
    queue: list[tuple[str, Any]]
    published: list[int]
    delayed: list[tuple[float, str, Any]]


class Commands:
    """The values on the ports of topics and actions.

    Attributes:
        values: Topic or action → the valid value.
        expiries: Topic → when its value expires (s).
        queue: Pending topics and values, applied at the next step in this order.
        delayed: Time of arrival (s), topic and message of what is under way to robots with a command delay.
        schedule: The scenario's own commands.
        silenced: Topics whose scheduled commands are dropped.
    """

    _context: Context
    _controls: Mapping[str, RobotControl]
    _clock: Clock

    def __init__(self) -> None:
        self.values: dict[str, Any] = {}
        self.expiries: dict[str, float] = {}
        self.queue: list[tuple[str, Any]] = []
        self.delayed: list[tuple[float, str, Any]] = []
        self.schedule: list[ScheduledCommand] = []
        self.silenced: set[str] = set()
        self._ports: dict[str, CommandTopic] = {}
        self._fixed: dict[str, FixedInputPortValue] = {}
        self._before: _Before | None = None

    def use(self, physics: Physics, controls: Mapping[str, RobotControl], clock: Clock) -> None:
        """Switch to a newly built diagram, without any command."""
        self._ports = physics.built.commanded | physics.built.actions
        self._context = physics.context
        self._controls = controls
        self._clock = clock
        self.start(())

    def start(self, commands: Sequence[Command]) -> None:
        """Remove all commands; those of a scenario are ahead."""
        self.values.clear()
        self.expiries.clear()
        self.queue, self.delayed = [], []
        self.schedule = [ScheduledCommand(command) for command in commands]
        self._fixed = {topic: item.port.FixValue(self._context, empty_value()) for topic, item in self._ports.items()}

    def last(self, topic: str) -> Any:
        """Return the value published last on a topic, pending or valid; None without one."""
        return next((value for name, value in reversed(self.queue) if name == topic), self.values.get(topic))

    def pend(self, topic: str, value: Any) -> None:
        """Let a value be applied at the next step.

        Where many are pending, the newest of each topic stays: a topic's port has one value, as the buffer of a
        controller of ros2_control has.
        """
        self.queue.append((topic, value))
        if len(self.queue) > _MOST_PENDING + 2 * len(self._ports):
            self.queue = [*{entry[0]: entry for entry in reversed(self.queue)}.values()][::-1]

    def hold(self, topic: str, message: Any, time: float) -> None:
        """Let a message arrive at a later time (s); of many with the same one, the newest of each topic."""
        delayed = [*self.delayed, (time, topic, message)]
        if len(delayed) > _MOST_PENDING + 2 * len(self._ports):
            delayed = [*{entry[:2]: entry for entry in reversed(delayed)}.values()][::-1]
        self.delayed = delayed

    def put_pending(self, time: float, action: CommandTopic | None = None) -> None:
        """Apply the pending commands to their input ports.

        Args:
            time: The present time (s).
            action: Apply only the commands of this action's controller, so that they precede a goal.
        """
        pending, self.queue = self.queue, []
        for topic, value in pending:
            if action is None or _is_of(self._ports[topic], action.robot, action.controller):
                self.set(topic, value, time)
            else:
                self.queue.append((topic, value))

    def apply(self, time: float, publish: Callable[[ScheduledCommand], None]) -> None:
        """Apply what is due at the present step: expired, scheduled and pending commands.

        Args:
            time: The present time (s).
            publish: Publishes a scheduled command as if a user had published it.
        """
        if not (self.schedule or self.expiries or self.queue or self.delayed):
            self._before = None
            return
        published = list(map(_published, self.schedule))
        self._before = _Before(dict(self.values), dict(self.expiries), self.queue, published, self.delayed)
        due = []
        for scheduled in self.schedule:
            if scheduled.due_step(self._clock.time_step) <= self._clock.step:
                if scheduled.topic not in self.silenced:
                    due.append(scheduled)
                scheduled.pass_step()
        for topic in [*self.expiries]:
            if self.expiries[topic] <= time + _ROUNDING:
                self.set(topic, None, time)
        pending, self.queue = self.queue, []
        if self.delayed:
            self._take_arrived()
        for scheduled in due:
            publish(scheduled)
        for topic, value in self.queue + pending:
            self.set(topic, value, time)
        self.queue = []

    def _take_arrived(self) -> None:
        """Queue the delayed messages that arrive at the present step, if their controllers still hear them."""
        under_way = []
        for time, topic, message in self.delayed:
            if step_at(time, self._clock.time_step) > self._clock.step:
                under_way.append((time, topic, message))
                continue
            item = self._ports[topic]
            control = self._controls[item.robot]
            if control.stopped or not control.manager.is_active(item.controller):
                continue
            try:
                self.queue.append((topic, control.read(item, message)))
            except CommandError as error:
                node = f"{control.plan.robot.topic_namespace}/{item.controller}"
                _log.warning("%s", error.about(topic), extra={"node": node})
                if error.deactivates:
                    control.deactivate(item.controller, error.about(topic).message)
        self.delayed = under_way

    def take_back(self) -> None:
        """Undo the last `apply`: the step that was to follow has failed."""
        if self._before is None:
            return
        for topic in self._ports:
            if self.values.get(topic) is not self._before.values.get(topic):
                self._fix(topic, self._before.values.get(topic))
        self.values, self.expiries, self.queue = self._before.values, self._before.expiries, self._before.queue
        self.delayed = self._before.delayed
        for item, published in zip(self.schedule, self._before.published, strict=True):
            item.published = published
        self._before = None

    def set(self, topic: str, value: Any, time: float) -> None:
        """Set the value of a port at a time (s); None clears it."""
        item, before = self._ports[topic], self.values.pop(topic, None)
        control = self._controls[item.robot]
        controller = control.controllers[item.controller]
        self._put(topic, item, controller, value, time)
        if controller.starts_or_stops(before, value):
            control.follow_commands()

    def _put(self, topic: str, item: CommandTopic, controller: Controller, value: Any, time: float) -> None:
        # Not `set_value`: this call is on the shortest path from a message to a joint. FixValue would make a copy.
        self._fixed[topic].GetMutableData().set_value(NO_MESSAGE if value is None else value)
        self.expiries.pop(topic, None)
        if value is None:
            return
        self.values[topic] = value
        timeout = controller.timeout(item.name)
        if timeout is not None and isfinite(timeout):
            self.expiries[topic] = time + max(timeout, self._clock.time_step)

    def clear(self, robot: str, controller: str) -> None:
        """Remove the commands of a controller."""
        own = {name for name, item in self._ports.items() if _is_of(item, robot, controller)}
        self.queue = [entry for entry in self.queue if entry[0] not in own]
        for name in own:
            self._fix(name, None)
            self.values.pop(name, None)
            self.expiries.pop(name, None)

    def due_steps(self) -> list[float]:
        """Return the steps at which something is due."""
        if not (self.schedule or self.expiries or self.delayed):
            return []
        due = [item.due_step(self._clock.time_step) for item in self.schedule]
        times = (*self.expiries.values(), *(time for time, _, _ in self.delayed))
        return due + [step_at(time, self._clock.time_step) for time in times]

    def state(self) -> dict[str, Any]:
        """Return the entries of a snapshot that this part keeps."""
        delayed = [[time, topic, to_plain(message)] for time, topic, message in self.delayed]
        return {
            "commands": {topic: to_plain(value) for topic, value in self.values.items()},
            "expiries": dict(self.expiries),
            "waiting": [[topic, to_plain(value)] for topic, value in self.queue],
            "schedule": [item.published for item in self.schedule],
            "silenced": sorted(self.silenced & {item.topic for item in self.schedule}),
            **({"delayed": delayed} if delayed else {}),
        }

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entries that `state` returned, after `start` with the same scenario's commands.

        Raises:
            ValueError: If they are those of other robots.
            KeyError: Likewise.
        """
        time = self._clock.time
        for topic, value in state["commands"].items():
            item = self._ports[topic]
            controller = self._controls[item.robot].controllers[item.controller]
            self._put(topic, item, controller, self._saved(topic, value), time)
        if not set(state["expiries"]) <= set(state["commands"]):
            raise ValueError("what expires is not commanded")
        self.expiries = dict(state["expiries"])
        self.queue = [(topic, self._saved(topic, value)) for topic, value in state["waiting"]]
        self.delayed = [(time, topic, self._message(topic, plain)) for time, topic, plain in state.get("delayed", ())]
        for scheduled, published in zip(self.schedule, state["schedule"], strict=True):
            scheduled.published = published
        self.silenced = set(state["silenced"])

    def transfer(self, state: Mapping[str, Any], before: Sequence[Command], now: Sequence[Command]) -> None:
        """Set what of another diagram's state has a place in this one.

        Args:
            state: What `state` returned then.
            before: The scenario's commands then.
            now: The scenario's commands now; some of those then.
        """
        self.start(now)
        published, rest = [], [*zip(before, state["schedule"], strict=True)]
        for command in now:
            index = next((index for index, (known, _) in enumerate(rest) if known is command), None)
            published.append(0 if index is None else rest.pop(index)[1])
        kept = {topic: value for topic, value in state["commands"].items() if topic in self._ports}
        self.set_state(
            {
                "commands": kept,
                "expiries": {topic: time for topic, time in state["expiries"].items() if topic in kept},
                "waiting": [entry for entry in state["waiting"] if entry[0] in self._ports],
                "schedule": published,
                "silenced": self.silenced,
                "delayed": [entry for entry in state.get("delayed", ()) if entry[1] in self._ports],
            }
        )

    def _message(self, topic: str, plain: Any) -> Any:
        """Return a saved message that is under way."""
        item, message = self._ports[topic], from_plain(plain)
        kind = getattr(message, "__msgtype__", None)
        if kind != item.type:
            raise ValueError(f"{shortened(plain)} is not a message of {topic}")
        return message

    def _saved(self, topic: str, plain: Any) -> Any:
        """Return a saved command as its port takes it."""
        item = self._ports[topic]
        value = from_plain(plain)
        kind = getattr(value, "__msgtype__", None)
        control = self._controls[item.robot]
        controller = control.controllers[item.controller]
        if not is_dataclass(value) or (kind is not None and kind != controller.subscribed.get(item.name, kind)):
            raise ValueError(f"{shortened(plain)} is not a message of {topic}")
        if isinstance(value, Numbers) or kind == "std_msgs/msg/Float64MultiArray":
            return controller.read(item.name, value, control.context_of(item.controller))
        return value

    def _fix(self, topic: str, value: Any) -> None:
        set_value(self._fixed[topic].GetMutableData(), value)


def _is_of(item: CommandTopic, robot: str, controller: str) -> bool:
    return (item.robot, item.controller) == (robot, controller)
