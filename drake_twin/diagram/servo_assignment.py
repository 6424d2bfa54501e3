"""The assignment of controllers' values to the actuators of a robot."""

from collections.abc import Collection, Mapping, Sequence

from drake_twin.controllers.base_controller import Controller
from drake_twin.controllers.interface import Interface
from drake_twin.diagram.servo_gains import EFFORT, FREE, HOLD, POSITION, VELOCITY
from drake_twin.systems.joint_servo import ServoAssignment

# As in gz_ros2_control, if controllers have claimed several interfaces of one joint.
_PRECEDENCE = (VELOCITY, POSITION, EFFORT)


def assign(
    joints: Sequence[str | None],
    controllers: Mapping[str, Controller],
    active: Collection[str],
    holds: Sequence[float],
    modes: Sequence[str] | None = None,
    *,
    hold_joints: bool = True,
) -> ServoAssignment:
    """Return the assignment that follows from the active controllers' claims while they write nothing.

    Of several controllers that claim one joint, the one that claims its velocity drives it, else the one that claims
    its position. Other values of that controller for the joint apply as well: a position and a velocity claimed by one
    controller are followed together.

    Args:
        joints: The joint of each actuator; None for one that models friction.
        controllers: The controllers of the robot, in the order of the servo's ports.
        active: The names of the active controllers.
        holds: The position to hold where no controller writes one (rad or m).
        modes: How each actuator is driven while no controller writes to it; by default all are held.
        hold_joints: Whether an unclaimed joint is held; else it is limp.
    """
    claimed: dict[Interface, str] = {}
    sources: dict[tuple[str, Interface], int] = {}
    offset = 0
    for name, controller in controllers.items():
        if name in active:
            claimed.update(dict.fromkeys(controller.claims, name))
            for index, interface in enumerate(controller.interfaces):
                sources[name, interface] = offset + index
        offset += len(controller.interfaces)
    driven, rows = [], []
    for joint, idle in zip(joints, modes or [HOLD] * len(joints), strict=True):
        kinds = [] if joint is None else [kind for kind in _PRECEDENCE if Interface(joint, kind) in claimed]
        if joint is None or not kinds:
            driven.append(FREE if not hold_joints else HOLD if joint is None else idle)
            rows.append((-1, -1, -1))
            continue
        driver = claimed[Interface(joint, kinds[0])]
        position, velocity, effort = (
            sources.get((driver, Interface(joint, kind)), -1) for kind in (POSITION, VELOCITY, EFFORT)
        )
        driven.append(EFFORT if kinds[0] == EFFORT and position < 0 else idle)
        rows.append((position, velocity, effort))
    positions, velocities, efforts = (tuple(column) for column in zip(*rows, strict=True)) if rows else ((), (), ())
    return ServoAssignment(tuple(driven), tuple(map(float, holds)), positions, velocities, efforts)
