"""The state of a gripper's goal: reached, stalled or still executing."""

from dataclasses import field, replace

from drake_twin.dataclass import dataclass
from drake_twin.saved import saved


@saved("GripperGoal")
@dataclass(frozen=True)
class GripperGoal:
    """The goal of a gripper.

    Attributes:
        id: The goal's number, counted from 1; that of the last goal while the gripper holds.
        position: The position to move to (rad or m).
        effort: The largest effort (N·m or N).
        velocity: The largest velocity (rad/s or m/s).
        time: The time at which the goal was accepted (s).
    """

    id: int
    position: float
    effort: float
    velocity: float
    time: float


@saved("GripperRun")
@dataclass(frozen=True)
class GripperRun:
    """The progress of a goal.

    Attributes:
        id: The goal's number; 0 before the first.
        status: ``executing``, ``succeeded``, ``aborted`` or ``canceled``.
        last_movement: The last time at which the gripper moved faster than the threshold, or accepted the goal (s).
        position: Its position at the last update, or at the goal's end (rad or m).
        effort: Its commanded effort (N·m or N).
        stalled: Whether it stopped short of the goal.
        reached_goal: Whether it reached the goal.
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
        """Whether the goal is still being executed."""
        return self.status == "executing"


@dataclass(frozen=True, kw_only=True)
class StallRule:
    """What counts as reached and as stalled; names as in the gripper controllers' parameters.

    Attributes:
        goal_tolerance: The largest position error at which a goal is reached (rad or m).
        stall_velocity_threshold: The largest speed of a gripper at rest (rad/s or m/s).
        stall_timeout: The time at rest after which the gripper has stalled (s).
        allow_stalling: Whether a goal succeeds if the gripper stalls before it.
    """

    goal_tolerance: float = field(default=0.01, metadata={"lower": 0.0})
    stall_velocity_threshold: float = 0.001
    stall_timeout: float = 1.0
    allow_stalling: bool = False


def judged(
    run: GripperRun, rule: StallRule, time: float, goal: float, position: float, velocity: float, effort: float
) -> GripperRun:
    """Return a run after one update of the controller.

    Args:
        run: The run before; returned as it is unless it is executing.
        rule: What counts as reached and as stalled.
        time: The present time (s).
        goal: The position to move to (rad or m).
        position: The present position (rad or m).
        velocity: The present velocity (rad/s or m/s).
        effort: The commanded effort (N·m or N).
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
