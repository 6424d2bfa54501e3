"""Conversion between the messages of joint_trajectory_controller and plain values."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from drake_twin import messages
from drake_twin.control.tolerances import StateTolerance
from drake_twin.control.trajectory import TrajectoryPoint
from drake_twin.controllers.joint_trajectory_memory import JointTrajectoryMemory


def points_of(trajectory: Any) -> tuple[tuple[TrajectoryPoint, ...], tuple[float, ...], float | None]:
    """Return points, their times (s) and the start time (s; None for a stamp of zero) of a ``JointTrajectory``."""
    points = tuple(
        TrajectoryPoint(
            _floats(point.positions), _floats(point.velocities), _floats(point.accelerations), _floats(point.effort)
        )
        for point in trajectory.points
    )
    times = tuple(seconds_of(point.time_from_start) for point in trajectory.points)
    return points, times, seconds_of(trajectory.header.stamp) or None


def joint_tolerances_of(tolerances: Sequence[Any]) -> Mapping[str, StateTolerance]:
    """Return ``control_msgs/msg/JointTolerance`` messages by joint."""
    return {
        each.name: StateTolerance(float(each.position), float(each.velocity), float(each.acceleration))
        for each in tolerances
    }


def seconds_of(time: Any) -> float:
    """Convert a ``Time`` or ``Duration`` to seconds."""
    return (int(time.sec) * 1_000_000_000 + int(time.nanosec)) / 1e9


def state_message(joints: Sequence[str], time: float, memory: JointTrajectoryMemory) -> Any:
    """Return the ``JointTrajectoryControllerState`` of an update at a time (s)."""
    elapsed = time - memory.running.start
    return messages.JointTrajectoryControllerState(
        header=messages.header(time),
        joint_names=list(joints),
        reference=_point_message(replace(memory.reference, effort=()), elapsed - memory.delay),
        feedback=_point_message(replace(memory.feedback, effort=()), elapsed),
        error=_point_message(memory.error),
        output=_point_message(memory.output),
        **_no_multi_dof("reference", "feedback", "error", "output"),
        speed_scaling_factor=memory.speed_scaling_factor,
    )


def feedback_message(joints: Sequence[str], time: float, memory: JointTrajectoryMemory) -> Any:
    """Return the ``FollowJointTrajectory_Feedback`` of an update at a time (s)."""
    elapsed = time - memory.running.start
    return messages.FollowJointTrajectory_Feedback(
        header=messages.header(time),
        joint_names=list(joints),
        desired=_point_message(memory.reference, elapsed - memory.delay),
        actual=_point_message(memory.feedback, elapsed),
        error=_point_message(memory.error),
        **_no_multi_dof("desired", "actual", "error"),
    )


def _point_message(point: TrajectoryPoint, time_from_start: float = 0.0) -> Any:
    """Return a ``JointTrajectoryPoint``."""
    return messages.JointTrajectoryPoint(
        positions=np.array(point.positions),
        velocities=np.array(point.velocities),
        accelerations=np.array(point.accelerations),
        effort=np.array(point.effort),
        time_from_start=messages.duration_message(time_from_start),
    )


def _no_multi_dof(*fields: str) -> dict[str, Any]:
    """Return empty fields for joints with several degrees of freedom, which the controller does not have."""
    empty = messages.MultiDOFJointTrajectoryPoint(
        transforms=[], velocities=[], accelerations=[], time_from_start=messages.duration_message(0.0)
    )
    return {"multi_dof_joint_names": []} | {f"multi_dof_{field}": empty for field in fields}


def _floats(values: Any) -> tuple[float, ...]:
    return tuple(map(float, values))
