"""What a joint trajectory controller remembers, as plain frozen values."""

from dataclasses import dataclass

from drake_twin.control.pid import PidMemory
from drake_twin.control.tolerances import Tolerances
from drake_twin.control.trajectory import RunningTrajectory, Trajectory, TrajectoryPoint
from drake_twin.controllers.goal_state import GoalState
from drake_twin.frozen import Frozen
from drake_twin.saved import saved


@saved("TrajectoryCommand")
@dataclass(frozen=True)
class TrajectoryCommand(Frozen):
    """What stands on the ports ``joint_trajectory`` and ``follow_joint_trajectory``.

    Attributes:
        id: its number; a later command has a higher one, whichever of the two ports it is on.
        trajectory: what to follow.
        tolerances: how closely.
    """

    id: int
    trajectory: Trajectory
    tolerances: Tolerances


@saved("JointTrajectoryMemory")
@dataclass(frozen=True)
class JointTrajectoryMemory:
    """What a joint trajectory controller keeps from one update to the next.

    Attributes:
        running: the trajectory.
        tolerances: its tolerances.
        is_holding: whether it is there to hold the joints after a trajectory, so that no tolerance matters.
        delay: simulation time minus the trajectory's own, which speed scaling draws apart (s).
        last_id: the number of the last command that was taken up.
        goal: the present or last goal of the action.
        reference: the trajectory's state at the last update.
        feedback: the measured state then.
        error: reference minus feedback.
        output: what was commanded; of interfaces that it does not have, empty.
        speed_scaling_factor: how fast the trajectory ran.
        pids: the memory of each commanded joint's PID.
    """

    running: RunningTrajectory
    tolerances: Tolerances
    is_holding: bool
    delay: float
    last_id: int
    goal: GoalState | None
    reference: TrajectoryPoint
    feedback: TrajectoryPoint
    error: TrajectoryPoint
    output: TrajectoryPoint
    speed_scaling_factor: float
    pids: tuple[PidMemory, ...]
