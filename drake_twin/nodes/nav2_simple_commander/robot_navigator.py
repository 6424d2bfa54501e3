"""``BasicNavigator``: goals for Nav2's servers, one at a time, whose progress the node asks for."""

import time
from enum import Enum
from typing import Any

from drake_twin.nodes.message_classes import action_class, message_class, service_class
from drake_twin.nodes.rclpy import spin_once, spin_until_future_complete
from drake_twin.nodes.rclpy.action import ActionClient
from drake_twin.nodes.rclpy.duration import Duration
from drake_twin.nodes.rclpy.node import Node
from drake_twin.nodes.rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

_PATIENCE = 0.1  # s that isTaskComplete() spins
_CANCELED, _ABORTED, _SUCCEEDED = 5, 6, 4  # action_msgs/msg/GoalStatus
_STARTUP, _SHUTDOWN = 0, 4  # nav2_msgs/srv/ManageLifecycleNodes
_ACTIONS = {
    "navigate_through_poses": "NavigateThroughPoses",
    "navigate_to_pose": "NavigateToPose",
    "follow_waypoints": "FollowWaypoints",
    "follow_gps_waypoints": "FollowGPSWaypoints",
    "follow_path": "FollowPath",
    "compute_path_to_pose": "ComputePathToPose",
    "compute_path_through_poses": "ComputePathThroughPoses",
    "smooth_path": "SmoothPath",
    "spin": "Spin",
    "backup": "BackUp",
    "drive_on_heading": "DriveOnHeading",
    "assisted_teleop": "AssistedTeleop",
    "dock_robot": "DockRobot",
    "undock_robot": "UndockRobot",
}
_SERVICES = {
    "/map_server/load_map": "LoadMap",
    "/global_costmap/clear_entirely_global_costmap": "ClearEntireCostmap",
    "/local_costmap/clear_entirely_local_costmap": "ClearEntireCostmap",
    "/global_costmap/get_costmap": "GetCostmap",
    "/local_costmap/get_costmap": "GetCostmap",
}
_Message = Any


class TaskResult(Enum):
    """How a task has ended."""

    UNKNOWN = 0
    SUCCEEDED = 1
    CANCELED = 2
    FAILED = 3


_RESULTS = {_SUCCEEDED: TaskResult.SUCCEEDED, _ABORTED: TaskResult.FAILED, _CANCELED: TaskResult.CANCELED}


class BasicNavigator(Node):
    """A node that sends goals to Nav2.

    Args:
        node_name: Its name.
        namespace: Its namespace, in which Nav2's servers are looked for.

    Attributes:
        initial_pose: The pose (``PoseStamped``) that `setInitialPose` has set.
        initial_pose_received: Whether AMCL has told a pose.
        goal_handle: The goal of the present task.
        result_future: The result of the present task, once it is there.
        feedback: The last feedback of the present task.
        status: The status of the last task.
    """

    def __init__(self, node_name: str = "basic_navigator", namespace: str = ""):
        super().__init__(node_name=node_name, namespace=namespace)
        self.initial_pose = message_class("geometry_msgs/msg/PoseStamped")()
        self.initial_pose.header.frame_id = "map"
        self.initial_pose_received = False
        self.goal_handle: Any = None
        self.result_future: Any = None
        self.feedback: Any = None
        self.status: int | None = None
        self._action_clients = {
            name: ActionClient(self, action_class(f"nav2_msgs/action/{kind}"), name) for name, kind in _ACTIONS.items()
        }
        self._service_clients = {
            name: self.create_client(service_class(f"nav2_msgs/srv/{kind}"), name) for name, kind in _SERVICES.items()
        }
        pose = message_class("geometry_msgs/msg/PoseWithCovarianceStamped")
        last = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, reliability=ReliabilityPolicy.RELIABLE)
        self.localization_pose_sub = self.create_subscription(pose, "amcl_pose", self._localized, last)
        self.initial_pose_pub = self.create_publisher(pose, "initialpose", 10)

    def destroyNode(self) -> None:
        """Destroy the node."""
        self.destroy_node()

    def destroy_node(self) -> None:
        """Destroy the node and its clients."""
        for client in self._action_clients.values():
            client.destroy()
        super().destroy_node()

    # Tasks ------------------------------------------------------------------------------------------------------------

    def setInitialPose(self, initial_pose: _Message) -> None:
        """Tell AMCL where the robot is (``PoseStamped``)."""
        self.initial_pose_received = False
        self.initial_pose = initial_pose
        self._tell_initial_pose()

    def goToPose(self, pose: _Message, behavior_tree: str = "") -> bool:
        """Go to a pose (``PoseStamped``); return whether Nav2 has accepted the goal, as all tasks do."""
        position = pose.pose.position
        text = f"Navigating to goal: {position.x} {position.y}..."
        return self._begin("navigate_to_pose", text, pose=pose, behavior_tree=behavior_tree)

    def goThroughPoses(self, poses: list[_Message], behavior_tree: str = "") -> bool:
        """Go through poses (``PoseStamped``) without a stop."""
        text = f"Navigating with {len(poses)} goals...."
        return self._begin("navigate_through_poses", text, poses=poses, behavior_tree=behavior_tree)

    def followWaypoints(self, poses: list[_Message]) -> bool:
        """Go from pose to pose (``PoseStamped``), with the task of the waypoint follower at each."""
        return self._begin("follow_waypoints", f"Following {len(poses)} goals....", poses=poses)

    def followGpsWaypoints(self, gps_poses: list[_Message]) -> bool:
        """Go from place to place (``geographic_msgs/GeoPose``)."""
        return self._begin("follow_gps_waypoints", f"Following {len(gps_poses)} gps goals....", gps_poses=gps_poses)

    def spin(self, spin_dist: float = 1.57, time_allowance: int = 10) -> bool:
        """Turn by an angle (rad) on the spot, within some time (s)."""
        text = f"Spinning to angle {spin_dist}...."
        return self._begin("spin", text, target_yaw=spin_dist, time_allowance=_duration(time_allowance))

    def backup(self, backup_dist: float = 0.15, backup_speed: float = 0.025, time_allowance: int = 10) -> bool:
        """Back up by a distance (m) at a speed (m/s), within some time (s)."""
        text = f"Backing up {backup_dist} m at {backup_speed} m/s...."
        return self._straight("backup", text, backup_dist, backup_speed, time_allowance)

    def driveOnHeading(self, dist: float = 0.15, speed: float = 0.025, time_allowance: int = 10) -> bool:
        """Drive straight for a distance (m) at a speed (m/s), within some time (s)."""
        text = f"Drive {dist} m on heading at {speed} m/s...."
        return self._straight("drive_on_heading", text, dist, speed, time_allowance)

    def assistedTeleop(self, time_allowance: int = 30) -> bool:
        """Pass velocities on that do not lead into obstacles, for some time (s)."""
        return self._begin("assisted_teleop", "Assisting teleop....", time_allowance=_duration(time_allowance))

    def followPath(self, path: _Message, controller_id: str = "", goal_checker_id: str = "") -> bool:
        """Follow a ``nav_msgs/Path``."""
        given = {"path": path, "controller_id": controller_id, "goal_checker_id": goal_checker_id}
        return self._begin("follow_path", "Executing path...", **given)

    def dockRobotByPose(self, dock_pose: _Message, dock_type: str, nav_to_dock: bool = True) -> bool:
        """Dock at a pose (``PoseStamped``)."""
        given = {"dock_pose": dock_pose, "dock_type": dock_type, "navigate_to_staging_pose": nav_to_dock}
        return self._begin("dock_robot", "Docking at pose...", use_dock_id=False, **given)

    def dockRobotByID(self, dock_id: str, nav_to_dock: bool = True) -> bool:
        """Dock at a dock of the docking server's."""
        given = {"dock_id": dock_id, "navigate_to_staging_pose": nav_to_dock}
        return self._begin("dock_robot", f"Docking at dock ID: {dock_id}...", use_dock_id=True, **given)

    def undockRobot(self, dock_type: str = "") -> bool:
        """Leave the dock."""
        return self._begin("undock_robot", "Undocking from dock...", dock_type=dock_type)

    def cancelTask(self) -> None:
        """Cancel the present task."""
        self.info("Canceling current task.")
        if self.result_future:
            spin_until_future_complete(self, self.goal_handle.cancel_goal_async())

    def isTaskComplete(self) -> bool:
        """Spin for 0.1 s; return whether the present task has ended."""
        if not self.result_future:
            return True
        spin_until_future_complete(self, self.result_future, timeout_sec=_PATIENCE)
        if not self.result_future.result():
            return False
        self.status = self.result_future.result().status
        return True

    def getFeedback(self) -> _Message:
        """Return the present task's last feedback; None before the first."""
        return self.feedback

    def getResult(self) -> TaskResult:
        """Return how the last task has ended."""
        return _RESULTS.get(self.status or 0, TaskResult.UNKNOWN)

    # Servers ----------------------------------------------------------------------------------------------------------

    def waitUntilNav2Active(self, navigator: str = "bt_navigator", localizer: str = "amcl") -> None:
        """Wait until Nav2's navigator and its localizer are active; for AMCL until it has a pose, too."""
        if localizer != "robot_localization":  # which has no lifecycle
            self._wait_until_active(localizer)
        if localizer == "amcl":
            while not self.initial_pose_received:
                self.info("Setting initial pose")
                self._tell_initial_pose()
                self.info("Waiting for amcl_pose to be received")
                spin_once(self, timeout_sec=1.0)
        self._wait_until_active(navigator)
        self.info("Nav2 is ready for use!")

    def getPath(self, start: _Message, goal: _Message, planner_id: str = "", use_start: bool = False) -> _Message:
        """Return the planner's ``nav_msgs/Path`` between poses (``PoseStamped``); None if it finds none."""
        given = {"start": start, "goal": goal, "planner_id": planner_id, "use_start": use_start}
        result = self._ask("compute_path_to_pose", "Getting path...", **given)
        return None if result is None else result.path

    def getPathThroughPoses(
        self, start: _Message, goals: list[_Message], planner_id: str = "", use_start: bool = False
    ) -> _Message:
        """Return the planner's ``nav_msgs/Path`` through poses (``PoseStamped``); None if it finds none."""
        given = {"start": start, "goals": goals, "planner_id": planner_id, "use_start": use_start}
        result = self._ask("compute_path_through_poses", "Getting path...", **given)
        return None if result is None else result.path

    def smoothPath(
        self, path: _Message, smoother_id: str = "", max_duration: float = 2.0, check_for_collision: bool = False
    ) -> _Message:
        """Return a smoother ``nav_msgs/Path``; None if the smoother finds none."""
        given = {"path": path, "smoother_id": smoother_id, "check_for_collisions": check_for_collision}
        result = self._ask("smooth_path", "Smoothing path...", max_smoothing_duration=_duration(max_duration), **given)
        return None if result is None else result.path

    def changeMap(self, map_filepath: str) -> bool:
        """Let the map server load another map; return whether it has."""
        response = self._call("/map_server/load_map", map_url=map_filepath)
        if response.result:
            self.error("Change map request failed!")
            return False
        self.info("Change map request was successful!")
        return True

    def clearAllCostmaps(self) -> None:
        """Clear the local and the global costmap."""
        self.clearLocalCostmap()
        self.clearGlobalCostmap()

    def clearLocalCostmap(self) -> None:
        """Clear the local costmap."""
        self._call("/local_costmap/clear_entirely_local_costmap")

    def clearGlobalCostmap(self) -> None:
        """Clear the global costmap."""
        self._call("/global_costmap/clear_entirely_global_costmap")

    def getGlobalCostmap(self) -> _Message:
        """Return the global costmap (``nav2_msgs/Costmap``)."""
        return self._call("/global_costmap/get_costmap").map

    def getLocalCostmap(self) -> _Message:
        """Return the local costmap (``nav2_msgs/Costmap``)."""
        return self._call("/local_costmap/get_costmap").map

    def lifecycleStartup(self) -> None:
        """Start Nav2 by its lifecycle managers."""
        self._manage(_STARTUP)

    def lifecycleShutdown(self) -> None:
        """Shut Nav2 down by its lifecycle managers."""
        self._manage(_SHUTDOWN)

    def info(self, msg: str) -> None:
        """Log a message."""
        self.get_logger().info(msg)

    def warn(self, msg: str) -> None:
        """Log a warning."""
        self.get_logger().warning(msg)

    def error(self, msg: str) -> None:
        """Log an error."""
        self.get_logger().error(msg)

    def debug(self, msg: str) -> None:
        """Log a message for developers."""
        self.get_logger().debug(msg)

    def _begin(self, action: str, text: str, **goal: Any) -> bool:
        """Begin a task; return whether it is accepted."""
        self.result_future = self.feedback = None
        handle = self._sent(action, text, **goal)
        if not handle.accepted:
            self.error(f"The goal of {action} was rejected!")
            return False
        self.result_future = handle.get_result_async()
        return True

    def _straight(self, action: str, text: str, distance: float, speed: float, seconds: float) -> bool:
        target = message_class("geometry_msgs/msg/Point")(x=float(distance))
        return self._begin(action, text, target=target, speed=speed, time_allowance=_duration(seconds))

    def _ask(self, action: str, text: str, **goal: Any) -> _Message:
        """Return the result of an action that takes no time to speak of; None if it fails."""
        handle = self._sent(action, text, **goal)
        if not handle.accepted:
            self.error(f"The goal of {action} was rejected!")
            return None
        self.result_future = handle.get_result_async()
        spin_until_future_complete(self, self.result_future)
        self.status = self.result_future.result().status
        if self.status != _SUCCEEDED:
            self.warn(f"{action} failed with status code: {self.status}")
            return None
        return self.result_future.result().result

    def _sent(self, action: str, text: str, **goal: Any) -> Any:
        client = self._action_clients[action]
        self.debug(f"Waiting for '{action}' action server")
        while not client.wait_for_server(timeout_sec=1.0):
            self.info(f"'{action}' action server not available, waiting...")
        self.info(text)
        kind: Any = action_class(f"nav2_msgs/action/{_ACTIONS[action]}")
        future = client.send_goal_async(kind.Goal(**goal), self._hear_feedback)
        spin_until_future_complete(self, future)
        self.goal_handle = future.result()
        return self.goal_handle

    def _call(self, service: str, **request: Any) -> Any:
        client = self._service_clients[service]
        while not client.wait_for_service(timeout_sec=1.0):
            self.info(f"{service} service not available, waiting...")
        kind: Any = service_class(f"nav2_msgs/srv/{_SERVICES[service]}")
        future = client.call_async(kind.Request(**request))
        spin_until_future_complete(self, future)
        return future.result()

    def _manage(self, command: int) -> None:
        """Ask all lifecycle managers for a transition."""
        kind: Any = service_class("nav2_msgs/srv/ManageLifecycleNodes")
        for name, types in self.get_service_names_and_types():
            if "nav2_msgs/srv/ManageLifecycleNodes" in types:
                client = self.create_client(kind, name)
                client.wait_for_service()
                spin_until_future_complete(self, client.call_async(kind.Request(command=command)))
                self.destroy_client(client)

    def _wait_until_active(self, node: str) -> None:
        """Wait until a node of a lifecycle is active."""
        kind: Any = service_class("lifecycle_msgs/srv/GetState")
        client = self.create_client(kind, f"{node}/get_state")
        while not client.wait_for_service(timeout_sec=1.0):
            self.info(f"{node}/get_state service not available, waiting...")
        while True:
            future = client.call_async(kind.Request())
            spin_until_future_complete(self, future)
            if future.result() is not None and future.result().current_state.label == "active":
                return
            time.sleep(2.0)

    def _tell_initial_pose(self) -> None:
        message = message_class("geometry_msgs/msg/PoseWithCovarianceStamped")()
        message.pose.pose = self.initial_pose.pose
        message.header.frame_id = self.initial_pose.header.frame_id
        message.header.stamp = self.initial_pose.header.stamp
        self.info("Publishing Initial Pose")
        self.initial_pose_pub.publish(message)

    def _localized(self, message: _Message) -> None:
        self.debug("Received amcl pose")
        self.initial_pose_received = True

    def _hear_feedback(self, message: _Message) -> None:
        self.feedback = message.feedback


def _duration(seconds: float) -> _Message:
    return Duration(seconds=seconds).to_msg()
