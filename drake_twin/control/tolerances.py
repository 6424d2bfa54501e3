"""How far joints may be from their trajectory, as in joint_trajectory_controller."""

from collections.abc import Mapping, Sequence

from drake_twin.control.trajectory import TrajectoryPoint
from drake_twin.dataclass import dataclass
from drake_twin.errors import CommandError
from drake_twin.saved import saved

_ERASED = -1.0  # control_msgs/msg/JointTolerance: the joint may move without restriction
_FLOAT32_EPSILON = 2.0**-23


@saved("StateTolerance")
@dataclass(frozen=True)
class StateTolerance:
    """The largest errors of one joint (rad, rad/s, rad/s², or with m); 0 for any error."""

    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0


@saved("Tolerances")
@dataclass(frozen=True)
class Tolerances:
    """The tolerances of a trajectory.

    Attributes:
        path: Of each joint on the way.
        goal: Of each joint at the end.
        goal_time: How long after the end the goal tolerances may still be reached (s); 0 for no bound.
    """

    path: tuple[StateTolerance, ...]
    goal: tuple[StateTolerance, ...]
    goal_time: float = 0.0


def goal_tolerances(
    defaults: Tolerances,
    joints: Sequence[str],
    path: Mapping[str, StateTolerance],
    goal: Mapping[str, StateTolerance],
    goal_time: float,
) -> Tolerances:
    """Merge the tolerances of an action's goal with the defaults: 0 keeps the default, -1 removes the restriction.

    Args:
        defaults: The controller's own.
        joints: Its joints.
        path: Joint → tolerance on the way, of those that the goal names.
        goal: Joint → tolerance at the end.
        goal_time: As in `Tolerances`.

    Raises:
        CommandError: If a joint is unknown or a tolerance is negative.
    """
    for where, given in (("path", path), ("goal", goal)):
        for joint in given:
            if joint not in joints:
                raise CommandError(
                    f"{where}_tolerance names an unknown joint {joint!r}",
                    valid=joints,
                    value=joint,
                )

    def merged(where: str, given: Mapping[str, StateTolerance], default: StateTolerance, joint: str) -> StateTolerance:
        wanted = given.get(joint, StateTolerance())
        name = f"{where}_tolerance of joint {joint}"
        return StateTolerance(
            _resolved(default.position, wanted.position, name),
            _resolved(default.velocity, wanted.velocity, name),
            _resolved(default.acceleration, wanted.acceleration, name),
        )

    return Tolerances(
        tuple(merged("path", path, default, joint) for default, joint in zip(defaults.path, joints, strict=True)),
        tuple(merged("goal", goal, default, joint) for default, joint in zip(defaults.goal, joints, strict=True)),
        _resolved(defaults.goal_time, goal_time, "goal_time_tolerance"),
    )


def violation(joints: Sequence[str], error: TrajectoryPoint, tolerances: Sequence[StateTolerance]) -> str | None:
    """Say which joint's error is beyond its tolerance and by how much; return None when all are within."""
    for i, (joint, tolerance) in enumerate(zip(joints, tolerances, strict=True)):
        for what, errors, allowed in (
            ("position", error.positions, tolerance.position),
            ("velocity", error.velocities, tolerance.velocity),
            ("acceleration", error.accelerations, tolerance.acceleration),
        ):
            if errors and allowed > 0.0 and abs(errors[i]) > allowed:
                return f"the {what} error of joint {joint} is {errors[i]:g}, its tolerance {allowed:g}"
    return None


def _resolved(default: float, wanted: float, name: str) -> float:
    if wanted > 0.0:
        return wanted
    if abs(wanted - _ERASED) < _FLOAT32_EPSILON:
        return 0.0
    if wanted < 0.0:
        raise CommandError(f"the {name} is {wanted:g}; 0 means the default, -1 no restriction")
    return default
