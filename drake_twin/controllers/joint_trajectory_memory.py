"""The memory of a joint trajectory controller, as frozen values."""

from drake_twin.control.pid import PidMemory
from drake_twin.control.tolerances import Tolerances
from drake_twin.control.trajectory import RunningTrajectory, Trajectory, TrajectoryPoint
from drake_twin.controllers.goal_state import GoalState
from drake_twin.dataclass import dataclass
from drake_twin.frozen import Frozen
from drake_twin.saved import saved


@saved("TrajectoryCommand")
@dataclass(frozen=True)
class TrajectoryCommand(Frozen):
    """The value of the ports ``joint_trajectory`` and ``follow_joint_trajectory``.

    Attributes:
        id: A number; a later command on either port has a higher one.
        trajectory: The trajectory to follow.
        tolerances: Its tolerances.
    """

    id: int
    trajectory: Trajectory
    tolerances: Tolerances


@saved("JointTrajectoryMemory")
@dataclass(frozen=True)
class JointTrajectoryMemory:
    """What a joint trajectory controller keeps from one update to the next.

    Attributes:
        running: The trajectory.
        tolerances: Its tolerances.
        is_holding: Whether the trajectory holds the joints after another one, so that tolerances do not apply.
        delay: Simulation time minus the trajectory's own time, which differ by speed scaling (s).
        last_id: The id of the last executed command.
        goal: The last executed goal of the action.
        reference: The trajectory's state at the last update.
        feedback: The measured state at the last update.
        error: Reference minus feedback.
        output: The commands; empty for interfaces that the controller does not have.
        speed_scaling_factor: The factor of the trajectory's speed.
        pids: The memory of each commanded joint's PID.
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
