"""Lets the joints of a twin follow measured ones, and their servos, too: a servo would draw its joint back."""

from collections import deque
from collections.abc import Mapping
from dataclasses import replace
from math import exp

import numpy as np

from drake_twin.diagram.servo_gains import DOWN, EFFORT, FREE, HOLD, POSITION, UP
from drake_twin.systems.joint_servo import ServoAssignment
from drake_twin.twin.twin import Twin

_MEAN_OF_NORMAL = 0.7979  # of the absolute value of a standard normal number
_RUNNING = 0.02  # part of each measurement in a running mean
_WITHIN = 3.0  # standard deviations of a measurement's noise in which a joint at its commanded position may be
_REST = 2.0  # standard deviations of noise that a twin may be off once it has followed
_MOST_SHIFT = 0.1  # rad or m of a commanded position

# What a joint's servo does: nothing, it follows a velocity or brakes, it draws to a commanded position, or it holds the
# position at which the joint came to rest.
_NONE, _MOVING, _DRAWN, _STANDING = range(4)


class RunningNoise:
    """The standard deviation of a number's own noise, from third differences of its last measurements.

    Attributes:
        value: The standard deviation.
    """

    def __init__(self) -> None:
        self._last: deque[float] = deque(maxlen=4)
        self.value = 0.0

    def add(self, measured: float) -> float:
        """Add a measurement, and return the standard deviation."""
        self._last.append(measured)
        if len(self._last) == 4:
            a, b, c, d = self._last
            now = abs(d - 3 * c + 3 * b - a) / 20**0.5 / _MEAN_OF_NORMAL
            most = 3 * self.value if self.value else now
            self.value += _RUNNING * (min(now, most) - self.value) if self.value else now
        return self.value


def followed(difference: float, part: float, noise: float) -> float:
    """Return how much of a difference is made good: a part, and all but twice the noise of what was measured.

    Args:
        difference: The difference.
        part: The part.
        noise: The standard deviation of the measurement; zero if it is not known yet.
    """
    rest = (1.0 - part) * difference
    most = _REST * noise if noise > 0 else abs(rest)
    return difference - min(max(rest, -most), most)


class JointObserver:
    """The observer of one robot's joints.

    Args:
        twin: The twin.
        robot: The robot's name.
        joints: The time constant of joints' positions and velocities (s).
        servos: That of commanded positions, which the robot may reach a little beside (s).
    """

    def __init__(self, twin: Twin, robot: str, joints: float, servos: float):
        self._twin, self._robot = twin, robot
        self._time_constant, self._of_servos = joints, servos
        plan = next(plan for plan in twin.built.plans if plan.name == robot)
        self._followers = {joint.name for joint in plan.description.movable_joints if joint.mimic is not None}
        self._noise: dict[str, RunningNoise] = {}

    def correct(
        self, measured: Mapping[str, float], predicted: Mapping[str, float], since: float, *, whole: bool
    ) -> None:
        """Make a part of the differences good.

        Args:
            measured: ``JOINT.position``, ``JOINT.velocity`` and others (rad, rad/s, or m, m/s).
            predicted: The same of the twin.
            since: The time since the last measurement (s).
            whole: Whether the differences are made good wholly.
        """
        twin = self._twin
        parts, servo = twin.built.robots[self._robot], twin.built.parts[self._robot].servo
        context = twin.plant.GetMyMutableContextFromRoot(twin.context)
        state = twin.plant.GetPositionsAndVelocities(context, parts.instance)
        servo_context = None if servo is None else servo.GetMyMutableContextFromRoot(twin.context)
        assignment = None if servo is None else servo.assignment(servo_context)
        shift = np.zeros(0) if servo is None else servo.shift(servo_context)
        holds = [] if assignment is None else [*assignment.holds]
        part = 1.0 if whole else 1.0 - exp(-since / self._time_constant)
        slow = 1.0 if whole else 1.0 - exp(-since / self._of_servos)
        for name, value in measured.items():
            joint, _, kind = name.rpartition(".")
            if kind == "effort" or joint in self._followers:
                continue
            index = parts.layout.efforts.get(joint)
            role = _role(assignment, index)
            difference = value - predicted[name]
            at = parts.layout.velocities[joint]
            if kind == "velocity":
                if whole or role == _NONE:  # a servo knows its velocity: noise would be a fight with it
                    state[at] += part * difference
                continue
            noise = self._noise.setdefault(joint, RunningNoise()).add(value)
            if role == _DRAWN:
                difference -= 0.0 if whole else float(np.clip(difference, -_WITHIN * noise, _WITHIN * noise))
                shift[index] = np.clip(shift[index] + slow * difference, -_MOST_SHIFT, _MOST_SHIFT)
            elif index is not None and len(shift):
                shift[index] = 0.0
            way = difference if whole else followed(difference, part, noise)
            if index is not None and role == _STANDING:  # it stands where the robot's joint does
                holds[index] += way
            state[parts.layout.positions[joint]] += way
            if role == _NONE and f"{joint}.velocity" not in measured and not whole:
                # Critically damped, as an α-β filter: of positions alone velocities follow, too.
                state[at] += (1.0 - (1.0 - part) ** 0.5) ** 2 / since * difference
        twin.plant.SetPositionsAndVelocities(context, parts.instance, state)
        if servo is not None and not np.array_equal(shift, servo.shift(servo_context)):
            servo.set_shift(servo_context, shift)
        if servo is not None and assignment is not None and holds != [*assignment.holds]:
            servo.assign(servo_context, replace(assignment, holds=tuple(holds)))


def _role(assignment: ServoAssignment | None, index: int | None) -> int:
    if assignment is None or index is None or assignment.modes[index] in (EFFORT, FREE):
        return _NONE
    mode = assignment.modes[index]
    if mode in (POSITION, UP, DOWN) or assignment.positions[index] >= 0:
        return _DRAWN
    return _STANDING if mode == HOLD else _MOVING
