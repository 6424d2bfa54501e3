"""Trajectories that controllers execute, as MoveIt's simple controller manager has them.

Source: moveit_ros_planning's trajectory_execution_manager.cpp and moveit_simple_controller_manager (ros2).
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from action_msgs.msg import GoalStatus
from control_msgs.action import FollowJointTrajectory, GripperCommand
from rclpy.action import ActionClient
from rclpy.duration import Duration
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from drake_twin.dataclass import dataclass
from drake_twin.nodes.motion.error_codes import ErrorCode

_TYPES = {
    "FollowJointTrajectory": FollowJointTrajectory,
    "GripperCommand": GripperCommand,
    "ParallelGripperCommand": GripperCommand,
}


@dataclass(frozen=True)
class Controller:
    """A controller that executes trajectories: its name, its action's type, the joints, and the client."""

    name: str
    type: str
    joints: tuple[str, ...]
    client: ActionClient


def controllers_of(node: Node, parameters: Mapping[str, Any]) -> list[Controller]:
    """Return the controllers of ``moveit_simple_controller_manager``'s parameters; others are logged.

    Args:
        node: Gets the clients.
        parameters: Its parameters, with dots in their names.
    """
    found = []
    for name in parameters.get("controller_names") or ():
        kind = parameters.get(f"{name}.type", "")
        if kind not in _TYPES:
            node.get_logger().error(f"Unknown controller type: '{kind}' of controller '{name}'")
            continue
        action = f"{name}/{parameters.get(f'{name}.action_ns', '')}".rstrip("/")
        joints = tuple(parameters.get(f"{name}.joints") or ())
        found.append(Controller(name, kind, joints, ActionClient(node, _TYPES[kind], action)))
    return found


@dataclass
class _Run:
    goals: list[Any]
    ends_as: ErrorCode = ErrorCode.SUCCESS

    def stop(self, code: ErrorCode) -> None:
        if self.ends_as is ErrorCode.SUCCESS:
            self.ends_as = code
            for goal in self.goals:
                goal.cancel_goal_async()


class Execution:
    """Lets controllers execute trajectories, one at a time.

    Args:
        node: For its log and timers.
        controllers: Those that there are.
        scaling: How many times longer than planned a trajectory may take.
        margin: How much longer still (s).
    """

    def __init__(self, node: Node, controllers: Sequence[Controller], scaling: float, margin: float):
        self._node, self._controllers, self._scaling, self._margin = node, controllers, scaling, margin
        self._run: _Run | None = None

    def stop(self) -> None:
        """Cancel what is executed."""
        if self._run is not None:
            self._run.stop(ErrorCode.PREEMPTED)

    async def run(self, trajectory: JointTrajectory) -> ErrorCode:
        """Execute a trajectory; return what has become of it."""
        log = self._node.get_logger()
        if not trajectory.points:
            return ErrorCode.SUCCESS
        self.stop()
        parts = list(self._parts(trajectory))
        held = {name for controller, _ in parts for name in controller.joints}
        if left := [name for name in trajectory.joint_names if name not in held]:
            log.error(f"Unable to identify any set of controllers that can actuate the joints: [ {' '.join(left)} ]")
            return ErrorCode.CONTROL_FAILED
        for controller, _ in parts:
            if not controller.client.server_is_ready():
                log.error(f"Action client not connected to action server: {controller.name}")
                return ErrorCode.CONTROL_FAILED
        handles = [await controller.client.send_goal_async(goal) for controller, goal in parts]
        run = self._run = _Run([handle for handle in handles if handle.accepted])
        if len(run.goals) < len(handles):
            log.error("Goal request rejected by a controller")
            run.stop(ErrorCode.CONTROL_FAILED)
        last = trajectory.points[-1].time_from_start
        longest = (last.sec + last.nanosec * 1e-9) * self._scaling + self._margin
        timer = self._node.create_timer(longest, lambda: self._late(run))
        results = [await handle.get_result_async() for handle in run.goals]
        self._node.destroy_timer(timer)
        if self._run is run:
            self._run = None
        if run.ends_as is not ErrorCode.SUCCESS:
            return run.ends_as
        if all(result.status == GoalStatus.STATUS_SUCCEEDED for result in results):
            return ErrorCode.SUCCESS
        if any(result.status == GoalStatus.STATUS_CANCELED for result in results):
            return ErrorCode.PREEMPTED
        texts = {text for result in results if (text := getattr(result.result, "error_string", ""))}
        log.error(f"Controller handle reports status ABORTED {'; '.join(sorted(texts))}".rstrip())
        return ErrorCode.CONTROL_FAILED

    def _late(self, run: _Run) -> None:
        if run.ends_as is ErrorCode.SUCCESS:
            self._node.get_logger().error("Controller is taking too long to execute trajectory. Stopping trajectory.")
            run.stop(ErrorCode.TIMED_OUT)

    def _parts(self, trajectory: JointTrajectory) -> Iterator[tuple[Controller, Any]]:
        left = set(trajectory.joint_names)
        for controller in self._controllers:
            joints = [name for name in trajectory.joint_names if name in controller.joints and name in left]
            if not joints:
                continue
            left -= set(joints)
            if controller.type == "FollowJointTrajectory":
                yield controller, FollowJointTrajectory.Goal(trajectory=_of_joints(trajectory, joints))
            else:
                goal = GripperCommand.Goal()
                place = trajectory.joint_names.index(joints[0])
                last = trajectory.points[-1]
                goal.command.position = float(last.positions[place])
                goal.command.max_effort = float(last.effort[place]) if len(last.effort) > place else 0.0
                yield controller, goal


def _of_joints(trajectory: JointTrajectory, joints: Sequence[str]) -> JointTrajectory:
    places = [trajectory.joint_names.index(name) for name in joints]

    def picked(values: Sequence[float]) -> list[float]:
        return [float(values[place]) for place in places] if len(values) else []

    points = [
        JointTrajectoryPoint(
            positions=picked(point.positions),
            velocities=picked(point.velocities),
            accelerations=picked(point.accelerations),
            time_from_start=point.time_from_start,
        )
        for point in trajectory.points
    ]
    return JointTrajectory(header=trajectory.header, joint_names=list(joints), points=points)


def to_trajectory(names: Sequence[str], points: Sequence[Any], columns: Sequence[int]) -> JointTrajectory:
    """Return a message of `timed_path.TimedPoint` s, of some of their columns."""
    return JointTrajectory(
        joint_names=list(names),
        points=[
            JointTrajectoryPoint(
                positions=point.positions[columns].tolist(),
                velocities=point.velocities[columns].tolist(),
                accelerations=point.accelerations[columns].tolist(),
                time_from_start=Duration(seconds=point.time).to_msg(),
            )
            for point in points
        ],
    )
