"""Doubles of the servers that diagrams/nav2_and_moveit.py asks: Nav2's amcl and bt_navigator, or MoveIt's move_group.

They stand in for ``ros2 launch FILE``: with the real rclpy, and the messages of Nav2 and MoveIt.
"""

import sys
from itertools import pairwise
from math import atan2, cos, hypot, sin

import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile

PATH = [(0.0, 0.0), (1.0, -0.5), (2.4, -0.6), (3.4, 0.4), (4.2, 0.8)]  # m, around the pillar
SIM_TIME = [Parameter("use_sim_time", value=True)]
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Part(Node):
    """A node that is active, as lifecycle nodes say it."""

    def __init__(self, name):
        from lifecycle_msgs.srv import GetState

        super().__init__(name, parameter_overrides=SIM_TIME)
        self.group = ReentrantCallbackGroup()
        self.create_service(GetState, f"{name}/get_state", self._tell_state, callback_group=self.group)

    @staticmethod
    def _tell_state(_, response):
        response.current_state.id, response.current_state.label = 3, "active"
        return response


class Amcl(Part):
    def __init__(self):
        from geometry_msgs.msg import PoseWithCovarianceStamped
        from tf2_msgs.msg import TFMessage

        super().__init__("amcl")
        self._poses = self.create_publisher(PoseWithCovarianceStamped, "amcl_pose", LATCHED)
        self._transforms = self.create_publisher(TFMessage, "/tf", 100)
        self.create_subscription(PoseWithCovarianceStamped, "initialpose", self._poses.publish, 10)
        self.create_timer(0.1, self._place)

    def _place(self):
        from geometry_msgs.msg import TransformStamped
        from tf2_msgs.msg import TFMessage

        transform = TransformStamped(child_frame_id="rover_odom")
        transform.header.frame_id, transform.header.stamp = "map", self.get_clock().now().to_msg()
        transform.transform.rotation.w = 1.0
        self._transforms.publish(TFMessage(transforms=[transform]))


class BtNavigator(Part):
    """Drives along a path to the goal, steered by where the rover really is."""

    def __init__(self):
        from geometry_msgs.msg import TwistStamped
        from nav2_msgs.action import NavigateToPose
        from nav_msgs.msg import Odometry

        super().__init__("bt_navigator")
        self._pose = None
        self._commands = self.create_publisher(TwistStamped, "/rover/drive_controller/cmd_vel", 1)
        self.create_subscription(Odometry, "/rover/ground_truth/odom", self._hear, 10, callback_group=self.group)
        options = {"callback_group": self.group}
        self._server = ActionServer(self, NavigateToPose, "navigate_to_pose", self._navigate, **options)

    def _hear(self, message):
        self._pose = message.pose.pose

    def _drive(self, forward, turn):
        from geometry_msgs.msg import TwistStamped

        command = TwistStamped()
        command.header.stamp = self.get_clock().now().to_msg()
        command.twist.linear.x, command.twist.angular.z = forward, turn
        self._commands.publish(command)

    def _navigate(self, handle):
        from nav2_msgs.action import NavigateToPose

        goal, rate = handle.request.pose.pose.position, self.create_rate(10)
        assert (goal.x, goal.y) == PATH[-1]
        for _, corner in pairwise(PATH):
            while True:
                rate.sleep()
                at, turned = self._pose.position, self._pose.orientation
                far = (corner[0] - at.x, corner[1] - at.y)
                if hypot(*far) < 0.2:
                    break
                yaw = 2 * atan2(turned.z, turned.w)
                off = atan2(far[1], far[0]) - yaw
                off = atan2(sin(off), cos(off))
                self._drive(0.4 * max(0.0, cos(off)), 1.5 * off)
                handle.publish_feedback(NavigateToPose.Feedback())
        self._drive(0.0, 0.0)
        handle.succeed()
        return NavigateToPose.Result()


class MoveGroup(Node):
    """Executes a goal's joint constraints as they are."""

    def __init__(self):
        from control_msgs.action import FollowJointTrajectory, GripperCommand
        from moveit_msgs.action import MoveGroup as Action

        super().__init__("move_group", parameter_overrides=SIM_TIME)
        group = ReentrantCallbackGroup()
        arm, gripper = "/joint_trajectory_controller/follow_joint_trajectory", "/gripper_controller/gripper_cmd"
        self._robot = {
            "arm": ActionClient(self, FollowJointTrajectory, arm, callback_group=group),
            "gripper": ActionClient(self, GripperCommand, gripper, callback_group=group),
        }
        self._server = ActionServer(self, Action, "move_action", self._move, callback_group=group)

    async def _move(self, handle):
        from moveit_msgs.action import MoveGroup as Action

        group = handle.request.request.group_name
        (constraints,) = handle.request.request.goal_constraints
        client = self._robot[group]
        sent = await client.send_goal_async(self._goal(group, constraints.joint_constraints))
        ended = await sent.get_result_async()
        handle.succeed()
        result = Action.Result()
        result.error_code.val = 1 if ended.status == 4 else -4  # SUCCESS, CONTROL_FAILED
        return result

    @staticmethod
    def _goal(group, constraints):
        from control_msgs.action import FollowJointTrajectory, GripperCommand
        from trajectory_msgs.msg import JointTrajectoryPoint

        if group == "gripper":
            goal = GripperCommand.Goal()
            goal.command.position = constraints[0].position
            return goal
        goal = FollowJointTrajectory.Goal()
        goal.trajectory.joint_names = [each.joint_name for each in constraints]
        point = JointTrajectoryPoint(positions=[each.position for each in constraints], velocities=[0.0] * 3)
        point.time_from_start.sec = 2
        goal.trajectory.points = [point]
        return goal


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    for node in (
        (Amcl(), Part("controller_server"), BtNavigator())
        if sys.argv[1].endswith("navigation.launch.py")
        else (MoveGroup(),)
    ):
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
