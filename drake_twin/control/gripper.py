"""When a gripper has reached its goal, and when it has stalled on the way."""

from dataclasses import dataclass, replace

from drake_twin.saved import saved


@saved("GripperGoal")
@dataclass(frozen=True)
class GripperGoal:
    """What a gripper is told.

    Attributes:
        id: the goal's number, counted from 1; that of the last goal while the gripper holds.
        position: the position to go to (rad or m).
        effort: the largest effort (N·m or N).
        velocity: the largest velocity (rad/s or m/s).
        time: when it was told (s).
    """

    id: int
    position: float
    effort: float
    velocity: float
    time: float


@saved("GripperRun")
@dataclass(frozen=True)
class GripperRun:
    """How a goal is getting on.

    Attributes:
        id: the goal's number; 0 before the first.
        status: ``executing``, ``succeeded``, ``aborted`` or ``canceled``.
        last_movement: when the gripper last moved faster than the threshold, or was told the goal (s).
        position: its position at the last update, or at the goal's end (rad or m).
        effort: the effort that it was given (N·m or N).
        stalled: whether it stopped short of the goal.
        reached_goal: whether it arrived.
    """

    id: int = 0
    status: str = ""
    last_movement: float = 0.0
    position: float = 0.0
    effort: float = 0.0
    stalled: bool = False
    reached_goal: bool = False

    @property
    def is_executing(self) -> bool:
        """Whether the goal is neither reached nor given up."""
        return self.status == "executing"


@dataclass(frozen=True)
class StallRule:
    """What counts as having arrived, and as having stalled; names as in the gripper controllers' parameters.

    Attributes:
        goal_tolerance: how near the goal is near enough (rad or m).
        stall_velocity_threshold: what is no faster stands still (rad/s or m/s).
        stall_timeout: how long it stands still before it has stalled (s).
        allow_stalling: whether a stall is success: a gripper that closes on an object stalls.
    """

    goal_tolerance: float = 0.01
    stall_velocity_threshold: float = 0.001
    stall_timeout: float = 1.0
    allow_stalling: bool = False


def judged(
    run: GripperRun, rule: StallRule, time: float, goal: float, position: float, velocity: float, effort: float
) -> GripperRun:
    """A run after one update of the controller.

    Args:
        run: the run before; one that does not execute comes back as it is.
        rule: what counts as arrived and as stalled.
        time: the present time (s).
        goal: the position to go to (rad or m).
        position: the present position (rad or m).
        velocity: the present velocity (rad/s or m/s).
        effort: the effort that the gripper is given (N·m or N).
    """
    if not run.is_executing:
        return run
    run = replace(run, position=position, effort=effort)
    if abs(goal - position) < rule.goal_tolerance:
        return replace(run, status="succeeded", reached_goal=True)
    if abs(velocity) > rule.stall_velocity_threshold:
        return replace(run, last_movement=time)
    if round(time - run.last_movement, 9) > rule.stall_timeout:  # ROS counts nanoseconds
        return replace(run, status="succeeded" if rule.allow_stalling else "aborted", stalled=True)
    return run
