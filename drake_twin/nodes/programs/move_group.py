"""``moveit_ros_move_group/move_group``: motions of arms that are planned and executed, without contact.

Source: moveit/moveit2, moveit_ros/move_group (its names, messages and errors). The planner is the twin's own:
RRT-Connect with times by TOPPRA, and a straight line for Pilz's LIN, whatever pipeline is asked for. A plan takes no
simulated time. Octomaps, visibility constraints, planes and displayed plans are not there; a mesh counts as its convex
hull.
"""

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any, cast

import numpy as np
import rclpy
from geometry_msgs.msg import Pose, PoseStamped
from move_group_execution import Execution, controllers_of, to_trajectory
from move_group_scene import Scene
from moveit_msgs.action import ExecuteTrajectory, MoveGroup
from moveit_msgs.msg import AttachedCollisionObject, CollisionObject, PlanningScene, RobotState
from moveit_msgs.srv import (
    ApplyPlanningScene,
    GetCartesianPath,
    GetMotionPlan,
    GetPlanningScene,
    GetPositionFK,
    GetPositionIK,
    GetStateValidity,
)
from pydrake.math import RigidTransform
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rclpy.time import Time
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_ros import Buffer, TransformException, TransformListener

from drake_twin.nodes.motion.arm_model import ArmModel
from drake_twin.nodes.motion.constraints import fill_pose, to_pose
from drake_twin.nodes.motion.error_codes import ErrorCode, PlanningError
from drake_twin.nodes.motion.planner import Planner
from drake_twin.nodes.motion.semantic_description import SemanticDescription, read_semantic_description
from drake_twin.nodes.motion.timed_path import timed
from drake_twin.nodes.task import present_task
from drake_twin.planning.robot_plan import RobotPlan

_ACCELERATION = 1.0  # rad/s² or m/s², of a joint without a limit, as in MoveIt


class MoveGroupNode(Node):
    """Plans for the twin's robot that its parameters describe."""

    def __init__(self) -> None:
        super().__init__("move_group", automatically_declare_parameters_from_overrides=True)
        self._plan = self._robot()
        self._semantics: SemanticDescription = read_semantic_description(
            self._parameter("robot_description_semantic", ""), self._plan.description
        )
        root = self._plan.description.root_link
        self._scene = Scene(root, self._semantics.touching)
        self._root, self._version, self._model = root, -1, ArmModel(self._plan)
        self._positions = np.clip(np.zeros(len(self._model.joints)), self._model.lower, self._model.upper)
        self._heard: set[str] = set()
        self._buffer = Buffer(node=self)
        TransformListener(self._buffer, self)
        manager = {
            name: item.value for name, item in self.get_parameters_by_prefix("moveit_simple_controller_manager").items()
        }
        execution = "trajectory_execution."
        self._execution = Execution(
            self,
            controllers_of(self, manager),
            self._parameter(f"{execution}allowed_execution_duration_scaling", 1.1),
            self._parameter(f"{execution}allowed_goal_duration_margin", 0.5),
        )
        self._offer()
        self.get_logger().info("You can start planning now!")

    def _robot(self) -> RobotPlan:
        """Return the twin's robot that the parameter ``robot_description`` describes."""
        text = self._parameter("robot_description", "")
        plans = list(present_task().program.rclpy["graph"].twin.built.plans)
        same = [plan for plan in plans if plan.description.text == text]
        named = [plan for plan in plans if f'name="{plan.description.name}"' in text]
        for found in (same, named, plans if not text else []):
            if found:
                return cast(RobotPlan, found[0])
        known = ", ".join(plan.description.name for plan in plans) or "none"
        raise SystemExit(
            f"move_group: the robot of the parameter robot_description is not in the twin, which has {known}"
        )

    def _offer(self) -> None:
        group = ReentrantCallbackGroup()
        services: tuple[tuple[Any, str, Callable[..., Any]], ...] = (
            (GetMotionPlan, "plan_kinematic_path", self._plan_path),
            (GetPositionFK, "compute_fk", self._forward),
            (GetPositionIK, "compute_ik", self._inverse),
            (GetCartesianPath, "compute_cartesian_path", self._cartesian),
            (GetStateValidity, "check_state_validity", self._validity),
            (GetPlanningScene, "get_planning_scene", self._give_scene),
            (ApplyPlanningScene, "apply_planning_scene", self._apply_scene),
        )
        for kind, name, callback in services:
            self.create_service(kind, name, callback, callback_group=group)
        self.create_subscription(JointState, "joint_states", self._hear, qos_profile_sensor_data, callback_group=group)
        self.create_subscription(CollisionObject, "collision_object", self._hear_object, 10)
        self.create_subscription(AttachedCollisionObject, "attached_collision_object", self._hear_attached, 10)
        self.create_subscription(PlanningScene, "planning_scene", self._hear_scene, 10)
        self.create_subscription(String, "trajectory_execution_event", self._hear_event, 10, callback_group=group)
        actions: tuple[tuple[Any, str, Callable[..., Any]], ...] = (
            (MoveGroup, "move_action", self._move),
            (ExecuteTrajectory, "execute_trajectory", self._execute),
        )
        for kind, name, callback in actions:
            ActionServer(self, kind, name, callback, callback_group=group, cancel_callback=self._cancel)
        if self._parameter("publish_robot_description_semantic", False):
            qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            publisher = self.create_publisher(String, "robot_description_semantic", qos)
            publisher.publish(String(data=self._parameter("robot_description_semantic", "")))

    def _parameter(self, name: str, default: Any) -> Any:
        value = self.get_parameter(name).value if self.has_parameter(name) else None
        return default if value is None else value

    # What it hears ---------------------------------------------------------------------------------------------------

    def _hear(self, message: JointState) -> None:
        values = dict(zip(message.name, message.position, strict=False))
        self._positions = self._model.from_names(values, self._positions)
        self._heard.update(values)

    def _hear_object(self, message: CollisionObject) -> None:
        self._warn(self._scene.process(message, self._place))

    def _hear_attached(self, message: AttachedCollisionObject) -> None:
        self._warn(self._scene.attach(message, self._place))

    def _hear_scene(self, message: PlanningScene) -> None:
        for text in self._scene.apply(message, self._place):
            self._warn(text)

    def _hear_event(self, message: String) -> None:
        if message.data == "stop":
            self._execution.stop()
        else:
            self._warn(f"Unknown event type: '{message.data}'")

    def _warn(self, text: str) -> None:
        if text:
            self.get_logger().error(text)

    # Services --------------------------------------------------------------------------------------------------------

    def _plan_path(self, request: Any, response: Any) -> Any:
        asked, answer = request.motion_plan_request, response.motion_plan_response
        answer.group_name = asked.group_name
        answer.error_code.val = self._guarded(lambda: self._fill_plan(asked, answer))
        return response

    def _fill_plan(self, asked: Any, answer: Any) -> None:
        planner, start = self._planner(asked.group_name), self._start(asked.start_state)
        self._fill_state(answer.trajectory_start, start)
        path = planner.path(start, asked)
        answer.trajectory.joint_trajectory = self._timed(planner, path, asked)

    def _forward(self, request: Any, response: Any) -> Any:
        def fill() -> None:
            positions = self._start(request.robot_state)
            for link in request.fk_link_names:
                if not self._model.has_link(link):
                    raise PlanningError(ErrorCode.INVALID_LINK_NAME, f"link '{link}' does not exist")
            frame = request.header.frame_id or self._world
            to_frame = self._frame(frame).inverse()
            for link in request.fk_link_names:
                response.pose_stamped.append(self._stamped(frame, to_frame @ self._model.pose(positions, link)))
                response.fk_link_names.append(link)

        response.error_code.val = self._guarded(fill)
        return response

    def _inverse(self, request: Any, response: Any) -> Any:
        def fill() -> None:
            asked = request.ik_request
            positions = self._planner(asked.group_name).inverse(self._start(asked.robot_state), asked)
            self._fill_state(response.solution, positions)

        response.error_code.val = self._guarded(fill)
        return response

    def _cartesian(self, request: Any, response: Any) -> Any:
        def fill() -> None:
            planner, start = self._planner(request.group_name), self._start(request.start_state)
            self._fill_state(response.start_state, start)
            link = request.link_name or planner.group.tip
            if request.max_step <= 0.0 or not planner.model.has_link(link):
                what = "Maximum step to take between consecutive configurations along Cartesian path must be positive"
                code = ErrorCode.FAILURE if request.max_step <= 0.0 else ErrorCode.INVALID_LINK_NAME
                raise PlanningError(code, what if request.max_step <= 0.0 else f"link '{link}' does not exist")
            to_root = self._frame(request.header.frame_id)
            poses = [to_root @ to_pose(pose) for pose in request.waypoints]
            path, response.fraction = planner.straight(
                start,
                link,
                poses,
                request.max_step,
                request.jump_threshold,
                request.path_constraints,
                avoid=request.avoid_collisions,
            )
            response.solution.joint_trajectory = self._timed(planner, path, request)

        response.error_code.val = self._guarded(fill)
        return response

    def _validity(self, request: Any, response: Any) -> Any:
        positions = self._start(request.robot_state)
        contact = self._surroundings().touching(positions)
        response.valid = contact is None
        return response

    def _give_scene(self, request: Any, response: Any) -> Any:
        scene = response.scene
        scene.robot_model_name = self._plan.description.name
        self._fill_state(scene.robot_state, self._positions)
        self._scene.fill(scene, self._plan.description.links)
        return response

    def _apply_scene(self, request: Any, response: Any) -> Any:
        wrong = self._scene.apply(request.scene, self._place)
        for text in wrong:
            self._warn(text)
        response.success = not wrong
        return response

    # Actions ---------------------------------------------------------------------------------------------------------

    async def _move(self, goal: Any) -> Any:
        asked, result = goal.request.request, MoveGroup.Result()
        self._state(goal, MoveGroup, "PLANNING")
        if goal.request.planning_options.planning_scene_diff.is_diff:
            self._hear_scene(goal.request.planning_options.planning_scene_diff)

        def fill() -> None:
            planner, start = self._planner(asked.group_name), self._start(asked.start_state)
            self._fill_state(result.trajectory_start, start)
            result.planned_trajectory.joint_trajectory = self._timed(planner, planner.path(start, asked), asked)

        code = self._guarded(fill)
        if code == ErrorCode.SUCCESS and not goal.request.planning_options.plan_only:
            self._state(goal, MoveGroup, "MONITOR")
            code = await self._run(result.planned_trajectory.joint_trajectory)
            result.executed_trajectory = result.planned_trajectory
        return self._ended(goal, result, code, MoveGroup)

    async def _execute(self, goal: Any) -> Any:
        self._state(goal, ExecuteTrajectory, "MONITOR")
        code = await self._run(goal.request.trajectory.joint_trajectory)
        return self._ended(goal, ExecuteTrajectory.Result(), code, ExecuteTrajectory)

    async def _run(self, trajectory: Any) -> ErrorCode:
        tolerance = self._parameter("trajectory_execution.allowed_start_tolerance", 0.01)
        if trajectory.points and tolerance > 0.0:
            here = self._model.with_followers(self._positions)
            first = dict(zip(trajectory.joint_names, trajectory.points[0].positions, strict=False))
            for name, value in first.items():
                if name in here and abs(here[name] - value) > tolerance:
                    self._warn(
                        f"Invalid Trajectory: start point deviates from current robot state more than {tolerance} at "
                        f"joint '{name}'. Expected: {value:.6g}, current: {here[name]:.6g}"
                    )
                    return ErrorCode.CONTROL_FAILED
        code: ErrorCode = await self._execution.run(trajectory)
        return code

    def _ended(self, goal: Any, result: Any, code: ErrorCode, kind: Any) -> Any:
        result.error_code.val = code
        if code == ErrorCode.SUCCESS:
            goal.succeed()
        elif goal.is_cancel_requested:
            goal.canceled()
        else:
            goal.abort()
        self._state(goal, kind, "IDLE")
        return result

    def _state(self, goal: Any, kind: Any, state: str) -> None:
        if state != "IDLE":  # a goal that has ended has no feedback
            goal.publish_feedback(kind.Feedback(state=state))

    def _cancel(self, goal: Any) -> CancelResponse:
        self._execution.stop()
        return CancelResponse.ACCEPT

    # Planning --------------------------------------------------------------------------------------------------------

    def _guarded(self, fill: Callable[[], None]) -> ErrorCode:
        try:
            fill()
        except PlanningError as error:
            self.get_logger().error(str(error))
            return error.code
        except ValueError as error:
            self.get_logger().error(str(error))
            return ErrorCode.FAILURE
        return ErrorCode.SUCCESS

    def _planner(self, group: str) -> Planner:
        known = self._semantics.groups
        if group not in known:
            text = f"group '{group}' does not exist; there are {', '.join(known)}"
            raise PlanningError(ErrorCode.INVALID_GROUP_NAME, text)
        turns = not self._parameter(f"robot_description_kinematics.{group}.position_only_ik", False)
        return Planner(self._surroundings(), known[group], self._place, turns)

    def _surroundings(self) -> ArmModel:
        if self._version != self._scene.version:
            self._model = ArmModel(self._plan, list(self._scene.bodies()), self._scene.may_touch)
            self._version = self._scene.version
        return self._model

    def _start(self, state: RobotState) -> np.ndarray:
        values = dict(zip(state.joint_state.name, state.joint_state.position, strict=False))
        return self._model.from_names(values, self._positions)

    def _timed(self, planner: Planner, path: list[np.ndarray], asked: Any) -> Any:
        columns = planner.indices
        limits = np.array([self._limits(name) for name in planner.group.joints])
        scales = np.array([asked.max_velocity_scaling_factor, asked.max_acceleration_scaling_factor])
        scales = np.where((scales > 0.0) & (scales <= 1.0), scales, 1.0)
        points = timed([point[columns] for point in path], *(limits * scales).T)
        return to_trajectory(planner.group.joints, points, list(range(len(columns))))

    def _limits(self, joint: str) -> tuple[float, float]:
        """Return a joint's largest velocity and acceleration."""
        limits = self._joint_limits
        velocity = self._plan.description.joints_by_name[joint].limits.velocity
        if limits.get(f"{joint}.has_velocity_limits"):
            velocity = limits.get(f"{joint}.max_velocity", velocity)
        fastest = velocity if np.isfinite(velocity) and velocity > 0 else 1.0
        has_limit = limits.get(f"{joint}.has_acceleration_limits")
        return fastest, limits.get(f"{joint}.max_acceleration", _ACCELERATION) if has_limit else _ACCELERATION

    @cached_property
    def _joint_limits(self) -> Mapping[str, Any]:
        found = self.get_parameters_by_prefix("robot_description_planning.joint_limits")
        return {name: item.value for name, item in found.items()}

    @property
    def _world(self) -> str:
        return self._semantics.world or self._root

    def _frame(self, name: str) -> RigidTransform:
        try:
            return self._place(name)
        except LookupError as error:
            raise PlanningError(ErrorCode.FRAME_TRANSFORM_FAILURE, str(error)) from None

    def _place(self, frame: str) -> RigidTransform:
        """Return a frame's pose in the root link.

        Raises:
            LookupError: If nothing says where it is.
        """
        if frame in ("", self._root, self._semantics.world):
            return RigidTransform()
        if self._model.has_link(frame):
            return self._model.pose(self._positions, frame)
        try:
            found = self._buffer.lookup_transform(self._root, frame, Time()).transform
        except TransformException as error:
            raise LookupError(f"frame '{frame}' is not known: {error}") from None
        pose = Pose(orientation=found.rotation)
        pose.position.x, pose.position.y, pose.position.z = (
            found.translation.x,
            found.translation.y,
            found.translation.z,
        )
        return to_pose(pose)

    def _fill_state(self, state: RobotState, positions: np.ndarray) -> None:
        values = self._model.with_followers(positions)
        state.joint_state.header.frame_id = self._world
        state.joint_state.header.stamp = self.get_clock().now().to_msg()
        state.joint_state.name, state.joint_state.position = list(values), list(values.values())

    def _stamped(self, frame: str, pose: RigidTransform) -> Any:
        found = PoseStamped()
        found.header.frame_id, found.header.stamp = frame, self.get_clock().now().to_msg()
        fill_pose(found.pose, pose)
        return found


def main() -> None:
    """Run the node."""
    rclpy.init()
    rclpy.spin(MoveGroupNode())
