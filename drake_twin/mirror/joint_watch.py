"""What goes wrong with a robot's joints and base while its twin is simulated: limits, efforts, tilt, missed goals."""

from math import acos, copysign, degrees, inf, isnan, pi, tau
from typing import Any

import numpy as np
from pydrake.multibody.tree import JointActuatorIndex

from drake_twin.control.trajectory import TrajectoryPoint
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import Joint
from drake_twin.mirror.trajectory_verdict import (
    EFFORT_LIMIT,
    NOT_REACHED,
    POSITION_LIMIT,
    TIPPING,
    VELOCITY_LIMIT,
    Allowed,
    Found,
)
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.twin.twin import Twin

_ROUNDING = 1e-3  # rad, m, or a part of a speed: by so much commands may be beyond a limit
_AT_LIMIT = 0.99  # of the effort limit


@dataclass(frozen=True)
class Goal:
    """Where a trajectory ends.

    Attributes:
        time: When (s from the fork).
        positions: Joint → position (rad or m).
    """

    time: float
    positions: dict[str, float]


class JointWatch:
    """Looks at one robot.

    Args:
        plan: The robot.
        allowed: What is not a problem.
        found: Where problems are noted.
    """

    def __init__(self, plan: RobotPlan, allowed: Allowed, found: Found):
        self.robot = plan.name
        self._allowed, self._found = allowed, found
        self._joints = {joint.name: joint for joint in plan.description.movable_joints}
        self._root, self._is_fixed = plan.model.root_body, plan.model.is_fixed
        self._up: np.ndarray | None = None  # in the root link's frame, at the start
        self._since: dict[int, float] = {}  # actuator → since when it is at its limit (s)
        self.goals: list[Goal] = []

    def use(self, twin: Twin) -> None:
        """Look at this twin, or at its newly built diagram; the first one is at the start."""
        self._twin, plant = twin, twin.plant
        parts = twin.built.robots[self.robot]
        self._instance, self._layout = parts.instance, parts.layout
        self._servo = twin.built.parts[self.robot].servo
        self._context = plant.GetMyContextFromRoot(twin.context)
        self._servo_context = None if self._servo is None else self._servo.GetMyContextFromRoot(twin.context)
        self._names = [name for name in self._joints if name in self._layout.positions]
        self._positions = [self._layout.positions[name] for name in self._names]
        self._velocities = [self._layout.velocities[name] for name in self._names]
        beyond, faster = self._allowed.position, 1.0 + self._allowed.velocity
        limits = [self._joints[name].limits for name in self._names]
        self._lower = np.array([limit.lower - beyond for limit in limits])
        self._upper = np.array([limit.upper + beyond for limit in limits])
        self._fastest = np.array([_speed(self._joints[name]) * faster for name in self._names])
        self._driven = {index: name for name, index in self._layout.efforts.items() if name in self._joints}
        actuators = [
            plant.get_joint_actuator(JointActuatorIndex(i)) for i in plant.GetJointActuatorIndices(parts.instance)
        ]
        self._inputs = [actuator.input_start() for actuator in actuators]
        self._strongest = _AT_LIMIT * np.array([actuator.effort_limit() for actuator in actuators])
        self._body = plant.GetBodyByName(self._root, parts.instance)
        if self._up is None:
            self._up = self._rotation()[2]

    def look(self, efforts: np.ndarray) -> None:
        """Note what is beyond its limits now.

        Args:
            efforts: Those of all actuators of the plant (N·m or N).
        """
        state = self._twin.plant.GetPositionsAndVelocities(self._context, self._instance)
        q, speed = state[self._positions], np.abs(state[self._velocities])
        for index in np.flatnonzero((q < self._lower) | (q > self._upper)):
            self._beyond_range(self._names[index], f"gets to {_number(q[index])}")
        for index in np.flatnonzero(speed > self._fastest):
            self._too_fast(self._names[index], "reaches", speed[index])
        if self._driven:
            self._look_at_commands()
            self._look_at_efforts(efforts[self._inputs])
        if not self._is_fixed and self._tilt() > self._allowed.tilt:
            text = f"{self.robot} tilts by more than {degrees(self._allowed.tilt):.3g}°"
            self._found.add(TIPPING, self.robot, (self._root,), text)
        if any(goal.time <= self._found.time + 1e-9 for goal in self.goals):
            self._look_at_goals(dict(zip(self._names, q.tolist(), strict=True)))

    def finish(self) -> None:
        """Note the goals whose time to settle was not simulated to its end."""
        for goal in self.goals:
            if goal.time <= self._found.time + 1e-9:
                self._miss(goal, self._positions_now())

    def check_trajectory(
        self, points: tuple[TrajectoryPoint, ...], times: tuple[float, ...], joints: tuple[str, ...], start: float
    ) -> None:
        """Note the points of a trajectory that are beyond limits, and its end as a goal.

        Args:
            points: The points, with one value for each joint.
            times: Their times from the start (s).
            joints: The names of the joints.
            start: The time of its start (s from the fork).
        """
        now = self._positions_now()
        for index, name in enumerate(joints):
            joint = self._joints.get(name)
            if joint is None:
                continue
            before, passed = now.get(name), 0.0
            for point, time in zip(points, times, strict=True):
                at = start + time
                if point.velocities:
                    self._check_speed(joint, abs(point.velocities[index]), at)
                if not point.positions:
                    before = None
                    continue
                q = point.positions[index]
                if q < joint.limits.lower - _ROUNDING or q > joint.limits.upper + _ROUNDING:
                    self._beyond_range(name, f"is commanded to {_number(q)}", at)
                if before is not None and time > passed:
                    way = q - before if joint.type != "continuous" else _turned(q - before)
                    self._check_speed(joint, abs(way) / (time - passed), start + passed)
                before, passed = q, time
        if points[-1].positions:
            self.goals.append(
                Goal(max(start + times[-1], self._found.time), dict(zip(joints, points[-1].positions, strict=True)))
            )

    def _check_speed(self, joint: Joint, speed: float, time: float) -> None:
        if speed > _speed(joint) * (1.0 + _ROUNDING):
            self._too_fast(joint.name, "is commanded to move at", speed, time)

    def _look_at_commands(self) -> None:
        servo, context = self._servo, self._servo_context
        if servo is None or context is None:
            return
        values: list[float] = []
        for index in range(servo.num_input_ports()):
            values += servo.get_input_port(index).Eval(context).tolist()
        assignment = servo.assignment(context)
        for actuator, name in self._driven.items():
            limits = self._joints[name].limits
            if (source := assignment.positions[actuator]) >= 0 and not isnan(q := values[source]):
                if q < limits.lower - _ROUNDING or q > limits.upper + _ROUNDING:
                    self._beyond_range(name, f"is commanded to {_number(q)}")
            elif (source := assignment.velocities[actuator]) >= 0:
                speed = abs(values[source])  # NaN without a command
                if speed > _speed(self._joints[name]) * (1.0 + self._allowed.velocity):
                    self._too_fast(name, "is commanded to move at", speed)

    def _look_at_efforts(self, efforts: np.ndarray) -> None:
        now = self._found.time
        for index in [index for index in self._since if abs(efforts[index]) < self._strongest[index]]:
            del self._since[index]
        for index in np.flatnonzero(np.abs(efforts) >= self._strongest).tolist():
            since = self._since.setdefault(index, now)
            if index in self._driven and now - since > self._allowed.effort_time:
                name = self._driven[index]
                limit = f"{_number(float(self._strongest[index]) / _AT_LIMIT)} {self._unit(name, 'N·m', 'N')}"
                text = f"the servo of {name} is at its limit of {limit} for more than {self._allowed.effort_time:g} s"
                self._found.add(EFFORT_LIMIT, self.robot, (name,), text, since)

    def _look_at_goals(self, positions: dict[str, float]) -> None:
        for goal in [*self.goals]:
            if goal.time > self._found.time + 1e-9:
                continue
            if not self._misses(goal, positions):
                self.goals.remove(goal)
            elif goal.time + self._allowed.settling <= self._found.time + 1e-9:
                self.goals.remove(goal)
                self._miss(goal, positions)

    def _misses(self, goal: Goal, positions: dict[str, float]) -> dict[str, float]:
        off: dict[str, float] = {}
        for name, wanted in goal.positions.items():
            if name in positions and not isnan(wanted):
                way = positions[name] - wanted
                off[name] = _turned(way) if self._joints[name].type == "continuous" else way
        return {name: way for name, way in off.items() if abs(way) > self._allowed.goal}

    def _miss(self, goal: Goal, positions: dict[str, float]) -> None:
        for name, way in self._misses(goal, positions).items():
            off = f"{_number(abs(way))} {self._unit(name, 'rad', 'm')} off the end of its trajectory"
            text = f"{name} is {off} (allowed is {self._allowed.goal:g})"
            self._found.add(NOT_REACHED, self.robot, (name,), text, goal.time)

    def _beyond_range(self, name: str, what: str, time: float | None = None) -> None:
        limits = self._joints[name].limits
        bounds = f"{_number(limits.lower)} to {_number(limits.upper)} {self._unit(name, 'rad', 'm')}"
        text = f"{name} {what}, beyond its range from {bounds}"
        self._found.add(POSITION_LIMIT, self.robot, (name,), text, time)

    def _too_fast(self, name: str, what: str, speed: float, time: float | None = None) -> None:
        limit, unit = self._joints[name].limits.velocity, self._unit(name, "rad/s", "m/s")
        text = f"{name} {what} {_number(speed)} {unit}, beyond its limit of {_number(limit)} {unit}"
        self._found.add(VELOCITY_LIMIT, self.robot, (name,), text, time)

    def _unit(self, name: str, turning: str, sliding: str) -> str:
        return sliding if self._joints[name].type == "prismatic" else turning

    def _positions_now(self) -> dict[str, float]:
        state = self._twin.plant.GetPositionsAndVelocities(self._context, self._instance)
        return dict(zip(self._names, state[self._positions].tolist(), strict=True))

    def _tilt(self) -> float:
        assert self._up is not None
        return acos(min(max(float(self._rotation()[2] @ self._up), -1.0), 1.0))

    def _rotation(self) -> Any:
        return self._body.EvalPoseInWorld(self._context).rotation().matrix()


def _speed(joint: Joint) -> float:
    """Return a joint's velocity limit; infinite where its file has zero, as some have that mean none."""
    return joint.limits.velocity if joint.limits.velocity > 0.0 else inf


def _turned(angle: float) -> float:
    """Return an angle without whole turns, from −π to π."""
    return angle - copysign(tau, angle) * int((abs(angle) + pi) / tau)


def _number(value: float) -> str:
    return f"{value:.4g}"
