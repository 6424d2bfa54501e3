"""Services and actions: of nodes among each other, and of the twin."""

from dataclasses import replace

import pytest
from node_runs import HEAD, lines, running, script

from drake_twin.builder.demo import demo_scenario
from drake_twin.scenario import NodeProgram
from drake_twin.services.node_programs import start_nodes
from drake_twin.twin.twin import Twin

TRAJECTORY = "/robot_1/joint_trajectory_controller/follow_joint_trajectory"


def test_a_client_and_a_service(tmp_path, capsys):
    server = script(
        tmp_path,
        "server.py",
        """
from std_srvs.srv import SetBool


class My(Node):
    def __init__(self):
        super().__init__("server")
        self.create_service(SetBool, "set", self.set)

    def set(self, request, response):
        response.success, response.message = request.data, str(self.get_clock().now().nanoseconds)
        return response
""",
    )
    client = script(
        tmp_path,
        "client.py",
        HEAD
        + """
from std_srvs.srv import SetBool

rclpy.init()
node = rclpy.create_node("client")
client = node.create_client(SetBool, "set")
print(node.create_client(SetBool, "nowhere").wait_for_service(timeout_sec=0.5))
while not client.wait_for_service(timeout_sec=1.0):
    pass
future = client.call_async(SetBool.Request(data=True))
rclpy.spin_until_future_complete(node, future)
print(future.result().success, future.result().message, node.get_clock().now().nanoseconds)
""",
    )
    with running(client, server) as twin:
        twin.advance_to(1.0)
        assert twin.findings == ()
    assert lines(capsys) == ["False", "True 501000000 502000000"]  # a step there, a step back


def test_a_service_of_the_twin(tmp_path, capsys):
    """Switching controllers, and a reset, which the twin can only do between two advances."""
    file = script(
        tmp_path,
        "client.py",
        HEAD
        + """
from controller_manager_msgs.srv import ListControllers, SwitchController
from std_srvs.srv import Empty

rclpy.init()
node = rclpy.create_node("client")


def call(kind, name, **fields):
    client = node.create_client(kind, name)
    assert client.wait_for_service(timeout_sec=1.0)
    future = client.call_async(kind.Request(**fields))
    rclpy.spin_until_future_complete(node, future)
    return future.result()


name = "forward_velocity_controller"
manager = "/robot_1/controller_manager"
print(call(SwitchController, f"{manager}/switch_controller", deactivate_controllers=[name], strictness=2).ok)
states = {item.name: item.state for item in call(ListControllers, f"{manager}/list_controllers").controller}
print(states[name])
node.get_clock().sleep_for(rclpy.duration.Duration(seconds=0.5))
call(Empty, "/reset_simulation")
print(node.get_clock().now().nanoseconds < 100000000)
""",
    )
    with running(file) as twin:
        assert twin.advance_to(1.0) == 0.0  # the reset ends the advance
        twin.advance_to(0.1)
        assert [str(item) for item in twin.findings] == []
    assert lines(capsys) == ["True", "inactive", "True"]


FOLLOW = """
from builtin_interfaces.msg import Duration
from control_msgs.action import FollowJointTrajectory
from rclpy.action import ActionClient
from trajectory_msgs.msg import JointTrajectoryPoint

rclpy.init()
node = rclpy.create_node("client")
client = ActionClient(node, FollowJointTrajectory, {action!r})
print(client.wait_for_server(timeout_sec=1.0))
goal = FollowJointTrajectory.Goal()
goal.trajectory.joint_names = {joints!r}
goal.trajectory.points = [JointTrajectoryPoint(positions={positions!r}, time_from_start=Duration(sec=1))]
feedback = []
future = client.send_goal_async(goal, feedback_callback=feedback.append)
rclpy.spin_until_future_complete(node, future)
handle = future.result()
print(handle.accepted)
{more}
future = handle.get_result_async()
rclpy.spin_until_future_complete(node, future)
print(future.result().status, future.result().result.error_code, len(feedback) > 5)
"""


def arm(*scripts):
    """An arm with its trajectory controller, and nodes."""
    scenario = demo_scenario("arduinobot", 1, drive=False)
    active = ("joint_state_broadcaster", "joint_trajectory_controller")
    robot = replace(scenario.robots[0], active_controllers=active, inactive_controllers=())
    twin = Twin(replace(scenario, robots=(robot,), nodes=tuple(NodeProgram(str(file)) for file in scripts)))
    start_nodes(twin)
    return twin


def trajectory(tmp_path, positions, more=""):
    """A node that lets the arm's first joints follow a trajectory, and the joints."""
    with arm() as twin:
        joints = [name for name in twin.joint_states("robot_1").name if "gripper" not in name][: len(positions)]
    text = FOLLOW.format(action=TRAJECTORY, joints=joints, positions=positions, more=more)
    return script(tmp_path, "client.py", HEAD + text), joints


def test_a_goal_of_the_twins_action(tmp_path, capsys):
    file, joints = trajectory(tmp_path, [0.3, 0.2, 0.1])
    with arm(file) as twin:
        twin.advance_to(3.0)
        assert [str(item) for item in twin.findings if "node" in str(item)] == []
        states = twin.joint_states("robot_1")
        found = [states.position[states.name.index(joint)] for joint in joints]
        assert found == pytest.approx([0.3, 0.2, 0.1], abs=0.01)
    assert lines(capsys) == ["True", "True", "4 0 True"]


def test_a_goal_that_is_canceled(tmp_path, capsys):
    more = (
        "node.get_clock().sleep_for(rclpy.duration.Duration(seconds=0.5))\n"
        "canceled = handle.cancel_goal_async()\n"
        "rclpy.spin_until_future_complete(node, canceled)\n"
        "print(canceled.result().return_code, len(canceled.result().goals_canceling))"
    )
    file, _ = trajectory(tmp_path, [0.3, 0.2, 0.1], more)
    with arm(file) as twin:
        twin.advance_to(2.0)
    out = lines(capsys)
    assert out[:3] == ["True", "True", "0 1"]
    assert out[3].startswith("5 ")


def test_a_goal_that_has_ended_is_not_canceled(tmp_path, capsys):
    """The code is rcl_action's for a goal in a terminal state that its server still keeps: 3."""
    more = (
        "rclpy.spin_until_future_complete(node, handle.get_result_async())\n"
        "canceled = handle.cancel_goal_async()\n"
        "rclpy.spin_until_future_complete(node, canceled)\n"
        "print(canceled.result().return_code, len(canceled.result().goals_canceling))"
    )
    file, _ = trajectory(tmp_path, [0.3, 0.2, 0.1], more)
    with arm(file) as twin:
        twin.advance_to(3.0)
    assert lines(capsys)[2] == "3 0"


def test_an_action_of_a_node(tmp_path, capsys):
    server = script(
        tmp_path,
        "server.py",
        """
import time
from control_msgs.action import GripperCommand
from rclpy.action import ActionServer, CancelResponse, GoalResponse


class My(Node):
    def __init__(self):
        super().__init__("server")
        self.server = ActionServer(self, GripperCommand, "grip", self.execute, goal_callback=self.decide)

    def decide(self, request):
        return GoalResponse.ACCEPT if request.command.position >= 0 else GoalResponse.REJECT

    def execute(self, handle):
        for step in range(3):
            handle.publish_feedback(GripperCommand.Feedback(position=step * 0.1))
            time.sleep(0.1)
        handle.succeed()
        return GripperCommand.Result(position=handle.request.command.position, reached_goal=True)
""",
    )
    client = script(
        tmp_path,
        "client.py",
        HEAD
        + """
from control_msgs.action import GripperCommand
from rclpy.action import ActionClient

rclpy.init()
node = rclpy.create_node("client")
client = ActionClient(node, GripperCommand, "grip")
client.wait_for_server()
for position in (-1.0, 0.5):
    goal = GripperCommand.Goal()
    goal.command.position = position
    feedback = []
    future = client.send_goal_async(goal, feedback_callback=lambda m: feedback.append(m.feedback.position))
    rclpy.spin_until_future_complete(node, future)
    print(future.result().accepted)
future = future.result().get_result_async()
rclpy.spin_until_future_complete(node, future)
print(future.result().status, future.result().result.position, feedback)
""",
    )
    with running(server, client) as twin:
        twin.advance_to(1.0)
        assert twin.findings == ()
    assert lines(capsys) == ["False", "True", "4 0.5 [0.0, 0.1, 0.2]"]


def test_a_goal_that_the_twin_rejects(tmp_path, capsys):
    file, _ = trajectory(tmp_path, [0.3], "raise SystemExit")
    with arm(file) as twin:
        twin.advance_to(0.5)
    assert lines(capsys) == ["True", "False"]
