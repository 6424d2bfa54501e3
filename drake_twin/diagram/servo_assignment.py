"""Which controller's values drive each actuator of a robot, and how."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from drake_twin.diagram.servo_gains import EFFORT, FREE, HOLD, POSITION, VELOCITY, ServoGains
from drake_twin.systems.controller import Controller, Interface
from drake_twin.systems.joint_servo import ServoAssignment

# As in gz_ros2_control, when controllers have claimed several interfaces of one joint.
_PRECEDENCE = (VELOCITY, POSITION, EFFORT)


def assign(
    joints: Sequence[str | None],
    controllers: Mapping[str, Controller],
    active: Collection[str],
    holds: Sequence[float],
    *,
    hold_joints: bool = True,
) -> ServoAssignment:
    """The assignment that follows from the active controllers' claims.

    Of several controllers that claim one joint, the one that claims its velocity drives it, else the one that claims
    its position. That controller's other values for the joint go with it: a position and a velocity claimed by one
    controller are followed together.

    Args:
        joints: the joint of each actuator; None for one that models friction.
        controllers: the controllers of the robot, in the order of the servo's ports.
        active: the names of those that are active.
        holds: the position to hold where no controller writes one (rad or m).
        hold_joints: whether a joint that no controller has claimed is held; else it is limp.
    """
    claimed: dict[Interface, str] = {}
    sources: dict[tuple[str, Interface], int] = {}
    offset = 0
    for name, controller in controllers.items():
        if name in active:
            claimed.update(dict.fromkeys(controller.claims, name))
            for index, interface in enumerate((*controller.claims, *controller.hints)):
                sources[name, interface] = offset + index
        offset += len(controller.claims) + len(controller.hints)
    modes, rows = [], []
    for joint in joints:
        kinds = [] if joint is None else [kind for kind in _PRECEDENCE if Interface(joint, kind) in claimed]
        if joint is None or not kinds:
            modes.append(HOLD if hold_joints else FREE)
            rows.append((-1, -1, -1))
            continue
        driver = claimed[Interface(joint, kinds[0])]
        position, velocity, effort = (
            sources.get((driver, Interface(joint, kind)), -1) for kind in (POSITION, VELOCITY, EFFORT)
        )
        modes.append(POSITION if position >= 0 else kinds[0])
        rows.append((position, velocity, effort))
    positions, velocities, efforts = (tuple(column) for column in zip(*rows, strict=True)) if rows else ((), (), ())
    return ServoAssignment(tuple(modes), tuple(map(float, holds)), positions, velocities, efforts)


def holds_after(
    before: ServoAssignment,
    set_points: Sequence[float],
    positions: np.ndarray,
    velocities: np.ndarray,
    gains: Sequence[ServoGains | None],
) -> list[float]:
    """Positions to hold when the assignment changes: no joint jumps, none turns back.

    A joint whose position was commanded or held keeps that set-point. One that was driven otherwise is held as far
    ahead as it takes to stop.

    Args:
        before: the assignment until now.
        set_points: the positions commanded or held until now (rad or m), an element for each actuator, as the rest.
        positions: where the joints are (rad or m).
        velocities: how they move (rad/s or m/s).
        gains: the servos' gains.
    """
    holds = []
    for mode, set_point, position, velocity, servo in zip(
        before.modes, set_points, positions, velocities, gains, strict=True
    ):
        if servo is None:
            holds.append(0.0)
        elif mode in (HOLD, POSITION):
            holds.append(set_point)
        else:
            holds.append(float(position + velocity * servo.stopping_time))
    return holds
