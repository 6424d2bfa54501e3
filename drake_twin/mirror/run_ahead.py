"""Simulate commands from a moment of a twin on, and look at each step for what goes wrong."""

import time as wall
from collections.abc import Sequence
from typing import Any

from drake_twin import messages
from drake_twin.controllers.joint_trajectory_messages import points_of
from drake_twin.errors import InputError, RunError
from drake_twin.mirror.joint_watch import JointWatch
from drake_twin.mirror.touch_watch import TouchWatch
from drake_twin.mirror.trajectory_verdict import FAILED, NOT_REACHED, REFUSED, Allowed, Found, Verdict
from drake_twin.scenario import DISCRETE
from drake_twin.twin.action import ActionGoal
from drake_twin.twin.snapshot import Snapshot
from drake_twin.twin.twin import Twin

Commands = Sequence[tuple[float, str, Any]]  # s from the fork, topic or action, message or its fields

TRAJECTORY, FOLLOW = "trajectory_msgs/msg/JointTrajectory", "control_msgs/action/FollowJointTrajectory"
LONGEST_STEP = 0.005  # s; an arm's tip at 2 m/s moves by 1 cm, which is less than it and an obstacle are thick
AFTER_COMMANDS = 5.0  # s that are simulated after commands whose end is not known
_LOOK = 0.01  # s between two looks at joints; touches are looked for at each step
_INSTANT = 1e-9


def run_ahead(
    twin: Twin,
    snapshot: Snapshot,
    commands: Commands,
    duration: float | None = None,
    allowed: Allowed | None = None,
    longest_step: float = LONGEST_STEP,
) -> Verdict:
    """Simulate commands from a snapshot on, as fast as possible.

    Args:
        twin: A twin for this alone: it is in another state afterwards.
        snapshot: Where to begin. Its scenario's own commands are published, too.
        commands: When (s from there) what is published on which topic, or sent as a goal to which action.
        duration: How long to simulate (s); by default to the end of the last trajectory and as long after it as joints
            may take to settle, and to `AFTER_COMMANDS` after the last command that has no end.
        allowed: What is not a problem.
        longest_step: The physics steps are at most so long (s): the longest multiple of the twin's at whose multiples
            all controllers are updated. Zero for the twin's own, which does what the twin would do to the last bit.

    Returns:
        What goes wrong. What the twin refuses is a problem, too; the simulation ends there.
    """
    begin = wall.monotonic()
    run = _Run(twin, allowed or Allowed())
    try:
        run.start(snapshot, longest_step)
        run.simulate(sorted(commands, key=lambda command: command[0]), duration)
    except RunError as error:
        run.found.add(FAILED, "", (), str(error))
    except InputError as error:
        run.found.add(REFUSED, "", (), str(error))
    return Verdict(run.found.problems(), run.found.time, wall.monotonic() - begin, run.steps)


class _Run:
    """One simulation.

    Attributes:
        found: What goes wrong.
        steps: The number of steps so far.
    """

    def __init__(self, twin: Twin, allowed: Allowed):
        self._twin, self._allowed = twin, allowed
        self.found = Found()
        self.steps = 0
        self._touches = TouchWatch(allowed, self.found)
        self._joints: dict[str, JointWatch] = {}
        self._looked = -1.0
        self._end = 0.0
        self._start = 0.0
        self._goals: list[tuple[ActionGoal, str]] = []

    def start(self, snapshot: Snapshot, longest_step: float) -> None:
        """Begin at a snapshot."""
        twin = self._twin
        twin.restore(snapshot)
        twin.play()
        self._start = twin.time
        self._joints = {plan.name: JointWatch(plan, self._allowed, self.found) for plan in twin.built.plans}
        self._use()
        if (step := _longer_step(twin, longest_step)) > twin.clock.time_step:
            twin.clock.set_time_step(step)

    def simulate(self, commands: Commands, duration: float | None) -> None:
        """Publish commands, step, and look."""
        twin, waiting = self._twin, [*commands]
        while True:
            if twin.built is not self._built:
                self._use()
            self.found.time = twin.time - self._start
            while waiting and waiting[0][0] <= self.found.time + _INSTANT:
                if not self._send(*waiting.pop(0)[1:]):
                    return
            end = self._end_of(waiting) if duration is None else duration
            self._look(is_last=self.found.time >= end - _INSTANT)
            if self.found.time >= end - _INSTANT:
                break
            twin.step()
            self.steps += 1
        for watch in self._joints.values():
            watch.finish()

    def _use(self) -> None:
        self._built = self._twin.built
        self._touches.use(self._twin)
        for watch in self._joints.values():
            watch.use(self._twin)

    def _end_of(self, waiting: Commands) -> float:
        if waiting:
            return waiting[-1][0] + AFTER_COMMANDS
        return self._end

    def _look(self, *, is_last: bool) -> None:
        self._touches.look()
        if self.found.time >= self._looked + _LOOK - _INSTANT or is_last:
            self._looked = self.found.time
            efforts = self._twin.graph.evaluate(self._twin.built.ports.net_actuation())
            for watch in self._joints.values():
                watch.look(efforts)
            for goal, robot in [*self._goals]:
                if goal.is_done:
                    self._goals.remove((goal, robot))
                    if goal.status == "aborted":
                        why = getattr(goal.result, "error_string", "") or "without a reason"
                        self.found.add(NOT_REACHED, robot, (goal.action,), f"{goal.action} is aborted: {why}")

    def _send(self, topic: str, data: Any) -> bool:
        """Publish a message, or send a goal; return whether the twin accepts it."""
        twin, built = self._twin, self._twin.built
        robot, is_action = "", topic in built.actions
        try:
            if is_action:
                item = built.actions[topic]
                robot = item.robot
                self._goals.append((twin.graph.send_goal(topic, data), robot))
            else:
                if not twin.graph.hears(topic):
                    twin.graph.command_topic(topic)  # raises with those that are valid
                if topic in built.listeners:
                    item = built.commanded[built.listeners[topic][0]]
                    robot = item.robot
                    self._check_active(topic, robot)
                twin.publish(topic, data)
        except InputError as error:
            self.found.add(REFUSED, robot, (topic,), str(error))
            return False
        self._note_end(topic, data, robot)
        return True

    def _check_active(self, topic: str, robot: str) -> None:
        items = [self._twin.built.commanded[port] for port in self._twin.built.listeners[topic]]
        if not any(self._twin.control.manager(item.robot).is_active(item.controller) for item in items):
            names = " and ".join(item.controller for item in items)
            raise InputError(f"{topic}: no controller hears this: {names} of {robot} is not active")

    def _note_end(self, topic: str, data: Any, robot: str) -> None:
        """Check the points of a trajectory, and simulate to its end."""
        built = self._twin.built
        kind = built.actions[topic].type if topic in built.actions else self._twin.graph.topics().get(topic, "")
        now, trajectory = self.found.time, None
        if kind == TRAJECTORY:
            trajectory = messages.message(kind, data)
        elif kind == FOLLOW:
            trajectory = messages.message(f"{FOLLOW}_Goal", data).trajectory
        if trajectory is None or robot not in self._joints:
            self._end = max(self._end, now + AFTER_COMMANDS)
            return
        points, times, stamp = points_of(trajectory)
        start = now if stamp is None else max(now, stamp - self._start)
        watch = self._joints[robot]
        names = tuple(trajectory.joint_names)
        watch.goals = [goal for goal in watch.goals if not goal.positions.keys() & set(names)]  # it replaces them
        watch.check_trajectory(points, times, names, start)
        self._end = max(self._end, start + times[-1] + self._allowed.settling)


def _longer_step(twin: Twin, longest: float) -> float:
    """Return the longest step (s) with which a twin's controllers are updated as before, or else its own."""
    own = twin.clock.time_step
    if twin.scenario.engine != DISCRETE:
        return own
    times = [delay for robot in twin.scenario.robots for delay in (robot.command_delay, robot.measurement_delay)]
    for parts in twin.built.parts.values():
        times += (controller.setup.update_period for controller in parts.controllers.values())
    for count in range(int(longest / own + 1e-6), 1, -1):
        step = round(count * own, 9)
        if all(abs(time / step - round(time / step)) < 1e-6 for time in times):
            return step
    return own
