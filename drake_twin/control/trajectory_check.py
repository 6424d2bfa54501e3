"""The checks of a trajectory before joint_trajectory_controller accepts it."""

from collections.abc import Sequence
from math import isfinite, nan

from drake_twin.control.trajectory import Trajectory, TrajectoryPoint
from drake_twin.dataclass import dataclass
from drake_twin.errors import CommandError

_FIELDS = ("positions", "velocities", "accelerations", "effort")
_FLOAT32_EPSILON = 2.0**-23


@dataclass(frozen=True)
class TrajectoryRules:
    """What a controller accepts.

    Attributes:
        joints: Its joints, in its order.
        allow_partial_joints_goal: Whether a trajectory may leave joints out.
        allow_integration: Whether points may lack positions.
        allow_nonzero_velocity_at_end: Whether the last point may have a velocity.
        has_effort: Whether points may have efforts.
    """

    joints: tuple[str, ...]
    allow_partial_joints_goal: bool = False
    allow_integration: bool = False
    allow_nonzero_velocity_at_end: bool = False
    has_effort: bool = False


def checked_trajectory(
    rules: TrajectoryRules,
    joints: Sequence[str],
    points: Sequence[TrajectoryPoint],
    times: Sequence[float],
    start: float | None,
    now: float,
) -> Trajectory:
    """Check a message's trajectory and sort it into the controller's order of joints.

    Args:
        rules: What the controller accepts.
        joints: The message's joints, in its own order.
        points: Its points, in that order.
        times: Their times from the start (s).
        start: The simulation time of the start (s); None to start at once.
        now: The present simulation time (s).

    Raises:
        CommandError: If the trajectory is refused.
    """
    _check_joints(rules, joints)
    if not points:
        raise CommandError("the trajectory has no points")
    _check_end(rules, joints, points[-1], times[-1], start, now)
    for i, (point, time) in enumerate(zip(points, times, strict=True)):
        if i > 0 and time <= times[i - 1]:
            raise CommandError(
                f"the times of the trajectory do not increase: point {i - 1} is at {times[i - 1]:g} s,"
                f" point {i} at {time:g} s"
            )
        _check_point(rules, joints, point, i)
    if tuple(joints) != rules.joints:
        places = {joint: place for place, joint in enumerate(joints)}
        points = [_sorted(point, [places.get(joint) for joint in rules.joints]) for point in points]
    return Trajectory(tuple(points), tuple(times), start)


def _check_joints(rules: TrajectoryRules, joints: Sequence[str]) -> None:
    if not joints:
        raise CommandError("the trajectory names no joints", valid=rules.joints)
    for i, joint in enumerate(joints):
        if joint not in rules.joints:
            raise CommandError(
                f"the trajectory names an unknown joint {joint!r}",
                valid=rules.joints,
                value=joint,
            )
        if joint in joints[:i]:
            raise CommandError(f"the trajectory names the joint {joint!r} twice")
    missing = [joint for joint in rules.joints if joint not in joints]
    if missing and not rules.allow_partial_joints_goal:
        raise CommandError(
            f"the trajectory leaves out {', '.join(missing)}, which only allow_partial_joints_goal permits"
        )


def _check_end(
    rules: TrajectoryRules,
    joints: Sequence[str],
    point: TrajectoryPoint,
    time: float,
    start: float | None,
    now: float,
) -> None:
    if not rules.allow_nonzero_velocity_at_end:
        for joint, velocity in zip(joints, point.velocities, strict=False):
            if abs(velocity) > _FLOAT32_EPSILON:
                raise CommandError(
                    f"the trajectory ends with a velocity of {velocity:g} at joint {joint}, which only"
                    " allow_nonzero_velocity_at_trajectory_end permits"
                )
    if start is not None and start + time < now:
        raise CommandError(
            f"the trajectory ends in the past: it starts at {start:g} s and ends at {start + time:g} s,"
            f" and it is {now:g} s"
        )


def _check_point(rules: TrajectoryRules, joints: Sequence[str], point: TrajectoryPoint, i: int) -> None:
    if point.effort and not rules.has_effort:
        raise CommandError(f"point {i} of the trajectory has efforts, but the controller does not command efforts")
    if not rules.allow_integration and not point.positions:
        raise CommandError(
            f"point {i} of the trajectory has no positions, which only allow_integration_in_goal_trajectories permits"
        )
    if not (point.positions or point.velocities or point.accelerations):
        raise CommandError(f"point {i} of the trajectory has no positions, velocities or accelerations")
    for field in _FIELDS:
        values = getattr(point, field)
        if values and len(values) != len(joints):
            raise CommandError(
                f"point {i} of the trajectory has {len(values)} {field} for {len(joints)} joints: {', '.join(joints)}"
            )
        for joint, value in zip(joints, values, strict=False):
            if not isfinite(value):
                raise CommandError(f"point {i} of the trajectory has {value} among its {field}, for joint {joint}")


def _sorted(point: TrajectoryPoint, places: Sequence[int | None]) -> TrajectoryPoint:
    """Return a point with its values in other places; a joint without one keeps its position and rests."""

    def moved(values: tuple[float, ...], otherwise: float) -> tuple[float, ...]:
        return tuple(otherwise if place is None else values[place] for place in places) if values else ()

    return TrajectoryPoint(
        moved(point.positions, nan),
        moved(point.velocities, 0.0),
        moved(point.accelerations, 0.0),
        moved(point.effort, 0.0),
    )
