"""Nodes that send goals by ``nav2_simple_commander``, beside a node that answers as Nav2 does."""

import pytest
from conftest import rovers
from interface_packages import write_package
from node_runs import lines, script

# Nav2's answers: an action takes a second, a node is active when it is asked again, AMCL repeats the initial pose.
NAV2 = """
import time
import rclpy
from geometry_msgs.msg import PoseWithCovarianceStamped
from lifecycle_msgs.srv import GetState
from nav2_msgs.action import ComputePathToPose, FollowWaypoints, NavigateToPose, Spin
from nav2_msgs.srv import LoadMap
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile

rclpy.init()
node = rclpy.create_node("nav2")
group = ReentrantCallbackGroup()
last = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
poses = node.create_publisher(PoseWithCovarianceStamped, "amcl_pose", last)
node.create_subscription(PoseWithCovarianceStamped, "initialpose", poses.publish, 10)
asked = {"bt_navigator": 0, "amcl": 1}


def state(request, response, name):
    asked[name] += 1
    response.current_state.label = "active" if asked[name] > 1 else "inactive"
    return response


def drive(handle, kind):
    for count in range(10):
        if handle.is_cancel_requested:
            handle.canceled()
            return kind.Result()
        feedback = kind.Feedback()
        if kind is NavigateToPose:
            feedback.distance_remaining = 1 - count / 10
        handle.publish_feedback(feedback)
        time.sleep(0.1)
    if kind is NavigateToPose and handle.request.pose.pose.position.x < 0:
        handle.abort()
    else:
        handle.succeed()
    result = kind.Result()
    if kind is ComputePathToPose:
        result.path.poses = [handle.request.start, handle.request.goal]
    return result


for kind, name in (
    (NavigateToPose, "navigate_to_pose"),
    (FollowWaypoints, "follow_waypoints"),
    (ComputePathToPose, "compute_path_to_pose"),
    (Spin, "spin"),
):
    ActionServer(
        node,
        kind,
        name,
        lambda handle, kind=kind: drive(handle, kind),
        callback_group=group,
        cancel_callback=lambda goal: CancelResponse.ACCEPT,
        goal_callback=lambda goal: GoalResponse(1 + bool(getattr(goal, "target_yaw", 0) < 9)),
    )
for name in asked:
    node.create_service(GetState, f"{name}/get_state", lambda q, r, name=name: state(q, r, name), callback_group=group)


def load_map(request, response):
    response.result = 0 if request.map_url == "good.yaml" else 2
    return response


node.create_service(LoadMap, "/map_server/load_map", load_map, callback_group=group)
executor = MultiThreadedExecutor()
executor.add_node(node)
executor.spin()
"""
COMMANDER = """
import rclpy
from geometry_msgs.msg import PoseStamped
from nav2_simple_commander.robot_navigator import BasicNavigator, TaskResult

rclpy.init()
navigator = BasicNavigator()


def pose(x):
    found = PoseStamped()
    found.header.frame_id = "map"
    found.pose.position.x = x
    return found


navigator.setInitialPose(pose(0.5))
navigator.waitUntilNav2Active()
print("active", navigator.initial_pose_received, navigator.initial_pose.pose.position.x)


def finish(*done, until=99):
    while not navigator.isTaskComplete():
        done += (navigator.getFeedback(),)
        if len(done) == until:
            navigator.cancelTask()
    print(navigator.getResult().name, len(done) > 5)


assert navigator.goToPose(pose(2.0))
finish()
print(f"{navigator.getFeedback().distance_remaining:.1f}")
assert navigator.goToPose(pose(-1.0))
finish()
assert navigator.followWaypoints([pose(1.0), pose(2.0)])
finish(until=3)
assert navigator.spin(spin_dist=1.5, time_allowance=4)
finish()
print("rejected", navigator.spin(spin_dist=10.0))
print("path", [each.pose.position.x for each in navigator.getPath(pose(0.0), pose(3.0)).poses])
print("maps", [navigator.changeMap(name) for name in ("good.yaml", "bad.yaml")])
navigator.destroy_node()
"""


@pytest.fixture
def run(tmp_path, capsys):
    """Runs a commander beside Nav2 until 20 s, and returns what it has printed."""

    def run_(text):
        (sources := tmp_path / "src").mkdir(exist_ok=True)
        builder = rovers(1, time_step=0.01).package_path(sources)
        builder.node(script(tmp_path, "commander.py", text))
        with builder.node(script(tmp_path, "nav2.py", NAV2)).build() as twin:
            twin.advance_to(20.0)
            assert twin.more_findings == []
        return [line for line in lines(capsys) if not line.startswith("[")]

    return run_


def test_tasks_end_as_nav2_says(run):
    said = run(COMMANDER)
    assert said == [
        "active True 0.5",
        *("SUCCEEDED True", "0.1"),
        "FAILED True",
        "CANCELED False",
        "SUCCEEDED True",
        "rejected False",
        "path [0.0, 3.0]",
        "maps [True, False]",
    ]


def test_a_workspaces_own_version_is_imported(tmp_path, run):
    package = write_package(tmp_path / "src", "nav2_simple_commander")
    script(package, "nav2_simple_commander/__init__.py", "WHOSE = 'own'\n")
    assert run("import nav2_simple_commander\nprint(nav2_simple_commander.WHOSE)\n") == ["own"]
