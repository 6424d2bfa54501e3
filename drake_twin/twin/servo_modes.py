"""The mode of each joint of a robot: it follows a command, brakes, or is held.

A joint without a commanded motion brakes with its full effort until it is at rest, and is held there. The same applies
to a commanded velocity of zero: a joint that followed the zero would creep under a load. If more than its effort pushes
it away, it is held where that leaves it.

A position that is farther away than its servo could approach within the joint's velocity limit is approached at that
limit. In Gazebo, gz_ros2_control writes ``gain · error`` as the velocity of a position interface, and the physics clamp
it to the joint's limit, with any value of ``enforce_command_limits``.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace
from math import inf, isnan

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription
from drake_twin.diagram.servo_gains import (
    BRAKE,
    DOWN,
    EFFORT,
    FREE,
    HOLD,
    POSITION,
    REST,
    REST_VELOCITY,
    UP,
    VELOCITY,
    ServoGains,
    velocity_limit,
)
from drake_twin.systems.joint_servo import ServoAssignment

# The period of checks of joints that brake or approach a far position, and of those held against a commanded velocity
# of zero, which may be pushed away (s).
CHECK_PERIOD = 0.01
_SLIP_PERIOD = 0.2

# A joint that rests this close to its commanded position is held at the command instead of its present position: the
# difference comes from its load, or from the object that it grips (rad or m).
_REACHED = 1e-2

# Farther than this from zero a joint is not held at its position, but continues to brake (rad or m): Drake's servo uses
# the position itself, and its solver fails for a light wheel that has turned by 1000 rad.
_FAR = 100.0

_ROUNDING = 1e-9
_LEAST_STIFFNESS = 1e-9  # of a servo whose file gives it none


@dataclass(frozen=True)
class DrivenJoint:
    """The limits of an actuator's joint.

    Attributes:
        stiffness: Its position servo's stiffness (N·m/rad or N/m).
        time_constant: The time constant with which the servo approaches a position and comes to rest (s).
        yields: The deviation from a held position at which the servo applies its full effort (rad or m).
        lower: The lowest position at which the joint is held (rad or m).
        upper: The highest position at which it is held (rad or m).
        velocity_limit: The largest velocity at which it approaches a position (rad/s or m/s).
    """

    stiffness: float
    time_constant: float
    yields: float
    lower: float
    upper: float
    velocity_limit: float


@dataclass(frozen=True)
class JointMotion:
    """The motion and commands of the joints of a robot's actuators; an element for each actuator.

    Attributes:
        positions: The positions (rad or m).
        velocities: The velocities (rad/s or m/s).
        gravity: The gravity loads (N·m or N); used at a check.
        commanded_positions: The commanded positions; NaN without a command.
        commanded_velocities: The commanded velocities; NaN without a command.
    """

    positions: Sequence[float]
    velocities: Sequence[float]
    gravity: Sequence[float]
    commanded_positions: Sequence[float]
    commanded_velocities: Sequence[float]


def driven_joints(
    description: RobotDescription, joints: Sequence[str | None], gains: Sequence[ServoGains | None]
) -> tuple[DrivenJoint | None, ...]:
    """Return the limits of each actuator's joint; None for an actuator that models friction."""
    driven: list[DrivenJoint | None] = []
    for joint, servo in zip(joints, gains, strict=True):
        if joint is None or servo is None:
            driven.append(None)
        else:
            limits = description.joints_by_name[joint].limits
            p, d = max(servo.position.p, _LEAST_STIFFNESS), servo.position.d
            fastest = velocity_limit(description, joint) if servo.limits_velocity else inf
            driven.append(DrivenJoint(p, d / p, servo.effort_limit / p, limits.lower, limits.upper, fastest))
    return tuple(driven)


def next_modes(
    now: ServoAssignment, joints: Sequence[DrivenJoint | None], motion: JointMotion, *, is_check: bool
) -> ServoAssignment:
    """Return the assignment with the modes that follow from the commands and the joints' motion.

    Args:
        now: The present assignment.
        joints: The limits of the joints.
        motion: Their motion.
        is_check: Whether joints may come to rest or slip now, which they do only at the times of `check_period`.
    """
    modes, holds = list(now.modes), list(now.holds)
    for index, joint in enumerate(joints):
        if joint is not None and modes[index] not in (EFFORT, FREE):
            modes[index], holds[index] = _next_mode(now, index, joint, motion, is_check=is_check)
    return now if modes == [*now.modes] else replace(now, modes=tuple(modes), holds=tuple(holds))


def without_commands(
    now: ServoAssignment, joints: Sequence[DrivenJoint | None], motion: JointMotion
) -> tuple[tuple[str, ...], tuple[float, ...]]:
    """Return the modes and held positions of joints that lose their commands: no joint jumps or turns back.

    A joint that rests at its commanded position is held there. Any other one brakes.
    """
    modes, holds = [BRAKE] * len(joints), list(now.holds)
    for index, (joint, mode) in enumerate(zip(joints, now.modes, strict=True)):
        if joint is None:
            continue
        position, velocity = motion.positions[index], motion.velocities[index]
        target = motion.commanded_positions[index]
        if mode == HOLD:
            modes[index] = HOLD
        elif mode == POSITION and abs(velocity) <= REST_VELOCITY and abs(target - position) <= _REACHED:
            modes[index], holds[index] = HOLD, float(np.clip(target, joint.lower, joint.upper))
    return tuple(modes), tuple(holds)


def released(now: ServoAssignment, indices: Collection[int]) -> ServoAssignment:
    """Return the assignment after joints have been moved: one with a commanded velocity is not pulled back.

    Args:
        now: The present assignment.
        indices: The indices of the joints' actuators.
    """
    modes = [BRAKE if i in indices and _may_slip(now, i) else mode for i, mode in enumerate(now.modes)]
    return replace(now, modes=tuple(modes))


def check_period(assignment: ServoAssignment) -> float | None:
    """Return the period at which to call `next_modes` again while commands stay the same (s); None for never."""
    if any(mode in (BRAKE, UP, DOWN) for mode in assignment.modes):
        return CHECK_PERIOD
    if any(_may_slip(assignment, index) for index in range(len(assignment.modes))):
        return _SLIP_PERIOD
    return None


def slipping_range(
    assignment: ServoAssignment, joints: Sequence[DrivenJoint | None]
) -> tuple[tuple[int, float, float], ...]:
    """Return the joints that slip outside of a range: actuator index, lower and upper end of each."""
    return tuple(
        (index, assignment.holds[index] - joint.yields, assignment.holds[index] + joint.yields)
        for index, joint in enumerate(joints)
        if joint is not None and _may_slip(assignment, index)
    )


def _next_mode(
    now: ServoAssignment, index: int, joint: DrivenJoint, motion: JointMotion, *, is_check: bool
) -> tuple[str, float]:
    """Return the next mode of a joint, and its held position."""
    mode, hold = now.modes[index], now.holds[index]
    position, velocity = motion.positions[index], motion.velocities[index]
    target, speed = motion.commanded_positions[index], motion.commanded_velocities[index]
    if isnan(speed):
        speed = 0.0
    if not isnan(target):
        approach = (target - position) / max(joint.time_constant, CHECK_PERIOD) + speed
        if abs(approach) <= joint.velocity_limit * (1 + _ROUNDING):
            return POSITION, hold
        return (UP if approach > 0 else DOWN), hold
    if speed != 0.0:
        return (VELOCITY if now.positions[index] < 0 else POSITION), hold
    if mode == HOLD:
        slips = is_check and _may_slip(now, index) and abs(hold - position) > joint.yields
        return (BRAKE if slips else HOLD), hold
    if mode == REST:
        return REST, hold
    if mode == BRAKE and is_check and abs(velocity) <= REST_VELOCITY:
        if abs(position) > _FAR:
            return REST, hold
        hold = position + velocity * joint.time_constant - motion.gravity[index] / joint.stiffness
        return HOLD, float(np.clip(hold, joint.lower, joint.upper))
    return BRAKE, hold


def _may_slip(assignment: ServoAssignment, index: int) -> bool:
    """Return whether a joint is held because its commanded velocity is zero."""
    is_velocity = assignment.velocities[index] >= 0 and assignment.positions[index] < 0
    return is_velocity and assignment.modes[index] == HOLD
