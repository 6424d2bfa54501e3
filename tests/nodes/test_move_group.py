"""``move_group`` for the bundled arm: poses by trigonometry, plans around objects, motions that controllers execute."""

import json
from math import asin, cos, hypot, pi, sin

import pytest
from node_runs import script
from program_runs import MODELS

from drake_twin import TwinBuilder

LAUNCH = MODELS / "arduinobot_moveit_config" / "launch"
BOTH = f"""
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription

def generate_launch_description():
    files = [{str(LAUNCH / "simulation.launch.py")!r}, {str(LAUNCH / "move_group.launch.py")!r}]
    return LaunchDescription([IncludeLaunchDescription(file) for file in files])
"""
HEAD = """
import json, time
import rclpy
from geometry_msgs.msg import Pose
from moveit_msgs.action import ExecuteTrajectory, MoveGroup
from moveit_msgs.msg import *
from moveit_msgs.srv import *
from rclpy.action import ActionClient
from sensor_msgs.msg import JointState
from shape_msgs.msg import SolidPrimitive
from std_msgs.msg import String

NAMES = ["joint_1", "joint_2", "joint_3"]
rclpy.init()
node = rclpy.create_node("client")
heard = []
node.create_subscription(JointState, "/joint_states", lambda item: heard.append(item), 10)
objects = node.create_publisher(CollisionObject, "/collision_object", 10)
held = node.create_publisher(AttachedCollisionObject, "/attached_collision_object", 10)
events = node.create_publisher(String, "/trajectory_execution_event", 10)

def done(future):
    rclpy.spin_until_future_complete(node, future)
    return future.result()

def call(kind, name, request):
    client = node.create_client(kind, name)
    client.wait_for_service()
    return done(client.call_async(request))

def wait(seconds):
    end = node.get_clock().now().nanoseconds + seconds * 1e9
    while node.get_clock().now().nanoseconds < end:
        rclpy.spin_once(node, timeout_sec=0.01)

def state(values, names=NAMES):
    return RobotState(joint_state=JointState(name=list(names), position=list(values)))

def to(*values, names=NAMES):
    return Constraints(joint_constraints=[
        JointConstraint(joint_name=name, position=value, tolerance_above=0.001, tolerance_below=0.001, weight=1.0)
        for name, value in zip(names, values)])

def asked(goal, group="arm", start=None, **more):
    return MotionPlanRequest(group_name=group, goal_constraints=[goal], start_state=start or RobotState(), **more)

def plan(goal, **more):
    request = GetMotionPlan.Request(motion_plan_request=asked(goal, **more))
    return call(GetMotionPlan, "plan_kinematic_path", request).motion_plan_response

def box(name, xyz, size, operation=CollisionObject.ADD, link="base_link"):
    pose = Pose()
    pose.position.x, pose.position.y, pose.position.z = xyz
    pose.orientation.w = 1.0
    item = CollisionObject(id=name, operation=operation, primitive_poses=[pose])
    item.primitives = [SolidPrimitive(type=SolidPrimitive.BOX, dimensions=size)]
    item.header.frame_id = link
    return item

def now():
    wait(0.02)
    return dict(zip(heard[-1].name, heard[-1].position))

def say(**values):
    print(json.dumps(values), flush=True)

wait(0.2)
"""


@pytest.fixture
def told(tmp_path, capsys):
    """Returns what a client says: the lines of JSON that it prints, as one dictionary."""

    def run(text, seconds):
        both = script(tmp_path, "both.launch.py", BOTH)
        builder = TwinBuilder().launch(both).node(script(tmp_path, "client.py", HEAD + text))
        with builder.build() as twin:
            twin.advance_to(seconds)
        lines = capsys.readouterr().out.splitlines()
        return {name: value for line in lines if line[:1] == "{" for name, value in json.loads(line).items()}

    return run


def claw(one, two, three):
    """Return where the claw is in the base link (m), by the lengths of the arm's links."""
    out, up = 0.3 * sin(two) + 0.246 * cos(two + three), 0.16 + 0.3 * cos(two) - 0.246 * sin(two + three)
    return [out * cos(one), out * sin(one), up]


def test_forward_and_inverse_kinematics(told):
    found = told(
        """
def forward(values, **more):
    request = GetPositionFK.Request(fk_link_names=["claw"], robot_state=state(values))
    request.header.frame_id = "base_link"
    return call(GetPositionFK, "compute_fk", request)

def inverse(xyz, group="arm", frame="base_link"):
    request = GetPositionIK.Request()
    request.ik_request.group_name, request.ik_request.avoid_collisions = group, True
    request.ik_request.pose_stamped.header.frame_id = frame
    place = request.ik_request.pose_stamped.pose.position
    place.x, place.y, place.z = xyz
    return call(GetPositionIK, "compute_ik", request)

place = forward([0.4, 0.3, -0.2]).pose_stamped[0]
say(frame=place.header.frame_id, xyz=[place.pose.position.x, place.pose.position.y, place.pose.position.z])
answer = inverse([0.25, 0.1, 0.35])
joints = answer.solution.joint_state
say(code=answer.error_code.val, joints=dict(zip(joints.name, joints.position)))
say(far=inverse([2.0, 0.0, 0.3]).error_code.val, group=inverse([0.25, 0.1, 0.35], group="leg").error_code.val)
say(unknown=inverse([0.25, 0.1, 0.35], frame="moon").error_code.val)
unknown = GetPositionFK.Request(fk_link_names=["tail"])
say(link=call(GetPositionFK, "compute_fk", unknown).error_code.val)
""",
        0.5,
    )
    assert found["frame"] == "base_link"
    assert found["xyz"] == pytest.approx(claw(0.4, 0.3, -0.2), abs=1e-9)
    assert found["code"] == 1
    joints = [found["joints"][f"joint_{number}"] for number in (1, 2, 3)]
    assert claw(*joints) == pytest.approx([0.25, 0.1, 0.35], abs=1e-4)
    assert found["joints"]["joint_5"] == pytest.approx(-found["joints"]["joint_4"])  # it follows
    assert (found["far"], found["group"], found["unknown"], found["link"]) == (-31, -15, -21, -18)


def test_a_goal_of_the_joints_is_planned_and_executed(told):
    found = told(
        """
client = ActionClient(node, MoveGroup, "/move_action")
client.wait_for_server()
states = []
goal = MoveGroup.Goal(request=asked(to(0.8, 0.4, -0.6), max_velocity_scaling_factor=0.5))
handle = done(client.send_goal_async(goal, lambda item: states.append(item.feedback.state)))
answer = done(handle.get_result_async())
points = answer.result.planned_trajectory.joint_trajectory.points
say(status=answer.status, code=answer.result.error_code.val, states=states, at=now(),
    fastest=max(abs(value) for point in points for value in point.velocities),
    hardest=max(abs(value) for point in points for value in point.accelerations),
    ends=[list(points[0].velocities), list(points[-1].velocities)])
say(lasts=points[-1].time_from_start.sec + points[-1].time_from_start.nanosec * 1e-9, points=len(points))
answer = plan(to(9.0, 0.0, 0.0))
say(outside=answer.error_code.val, group=plan(to(0.0, 0.0, 0.0), group="leg").error_code.val)
goal = MoveGroup.Goal(request=asked(to(0.3, names=["joint_4"]), group="gripper"))
answer = done(done(client.send_goal_async(goal)).get_result_async())
say(gripper=answer.result.error_code.val, open=now()["joint_4"])
""",
        6.0,
    )
    assert (found["status"], found["code"], found["states"]) == (4, 1, ["PLANNING", "MONITOR"])
    reached = [found["at"][f"joint_{number}"] for number in (1, 2, 3)]
    assert reached == pytest.approx([0.8, 0.4, -0.6], abs=2e-3)
    assert 0.7 < found["fastest"] <= 0.75 + 1e-6  # half of joint_limits.yaml's 1.5 rad/s
    assert 2.5 < found["hardest"] <= 3.0 + 1e-6
    assert found["ends"] == [[0.0] * 3, [0.0] * 3]
    assert found["lasts"] == pytest.approx(0.8 / 0.75 + 0.75 / 3.0, rel=1e-3)  # a trapezoid of joint_1's velocity
    assert (found["outside"], found["group"]) == (-16, -15)
    assert (found["gripper"], found["open"]) == (1, pytest.approx(0.3, abs=0.02))


def test_a_plan_leads_around_an_object(told):
    found = told(
        """
def valid(values):
    request = GetStateValidity.Request(robot_state=state(values), group_name="arm")
    return call(GetStateValidity, "check_state_validity", request).valid

start, end = [-0.7, 0.9, 0.0], [0.7, 0.9, 0.0]
free = plan(to(*end), start=state(start))
objects.publish(box("post", [0.35, 0.0, 0.2], [0.06, 0.06, 0.5]))
wait(0.05)
answer = plan(to(*end), start=state(start))
points = [list(point.positions) for point in answer.trajectory.joint_trajectory.points]
say(free=[free.error_code.val, max(abs(point.positions[1] - 0.9) for point in free.trajectory.joint_trajectory.points)],
    code=answer.error_code.val, first=points[0], last=points[-1], valid=[valid(point) for point in points],
    middle=valid([0.0, 0.9, 0.0]))
say(inside=plan(to(0.0, 0.9, 0.0), start=state(start)).error_code.val,
    outwards=plan(to(*end), start=state([0.0, 0.9, 0.0])).error_code.val)
scene = call(GetPlanningScene, "get_planning_scene", GetPlanningScene.Request()).scene
say(objects=[item.id for item in scene.world.collision_objects])
scene.allowed_collision_matrix.entry_names.append("post")
for entry in scene.allowed_collision_matrix.entry_values:
    entry.enabled.append(True)
size = len(scene.allowed_collision_matrix.entry_names)
scene.allowed_collision_matrix.entry_values.append(AllowedCollisionEntry(enabled=[True] * size))
say(applied=call(ApplyPlanningScene, "apply_planning_scene", ApplyPlanningScene.Request(scene=scene)).success,
    allowed=plan(to(0.0, 0.9, 0.0), start=state(start)).error_code.val)
scene.world.collision_objects = []
call(ApplyPlanningScene, "apply_planning_scene", ApplyPlanningScene.Request(scene=scene))
held.publish(AttachedCollisionObject(link_name="claw", touch_links=["finger_left", "finger_right"],
                                     object=box("rod", [0.2, 0.0, 0.0], [0.3, 0.02, 0.02], link="claw")))
wait(0.05)
say(folded=[valid([0.0, 0.5, 1.2]), valid([0.0, 0.0, 0.0])])
""",
        1.0,
    )
    assert found["free"] == [1, pytest.approx(0.0, abs=1e-6)]  # straight without the post
    assert found["code"] == 1
    assert found["first"] == pytest.approx([-0.7, 0.9, 0.0], abs=1e-6)
    assert found["last"] == pytest.approx([0.7, 0.9, 0.0], abs=1e-3)
    assert all(found["valid"])
    assert not found["middle"]
    assert (found["inside"], found["outwards"]) == (-12, -10)
    assert (found["objects"], found["applied"], found["allowed"]) == (["post"], True, 1)
    assert found["folded"] == [False, True]  # the rod would be in the pedestal


def test_a_straight_way_of_the_claw(told):
    found = told(
        """
def way(block):
    request = GetCartesianPath.Request(group_name="arm", link_name="claw", max_step=0.01, avoid_collisions=True)
    request.header.frame_id, request.start_state = "base_link", state([0.0, 0.5, 0.0])
    pose = Pose()
    pose.position.x, pose.position.y, pose.position.z = 0.3, 0.15, 0.25
    pose.orientation.w = 1.0
    request.waypoints = [pose]
    return call(GetCartesianPath, "compute_cartesian_path", request)

answer = way(False)
say(code=answer.error_code.val, fraction=answer.fraction,
    points=[list(point.positions) for point in answer.solution.joint_trajectory.points])
objects.publish(box("wall", [0.3, 0.15, 0.25], [0.05, 0.05, 0.05]))
wait(0.05)
say(blocked=way(True).fraction)
""",
        0.6,
    )
    assert (found["code"], found["fraction"]) == (1, 1.0)
    start, end = claw(0.0, 0.5, 0.0), [0.3, 0.15, 0.25]
    length = hypot(*(b - a for a, b in zip(start, end, strict=True)))
    for joints in found["points"]:
        here = claw(*joints)
        gone = hypot(*(b - a for a, b in zip(start, here, strict=True)))
        left = hypot(*(b - a for a, b in zip(here, end, strict=True)))
        assert gone + left == pytest.approx(length, abs=1e-4)
    assert claw(*found["points"][-1]) == pytest.approx(end, abs=1e-4)
    assert 0.2 < found["blocked"] < 0.9


def test_a_motion_is_stopped(told):
    found = told(
        """
client = ActionClient(node, MoveGroup, "/move_action")
client.wait_for_server()
def begun(*joints):
    handle = done(client.send_goal_async(MoveGroup.Goal(request=asked(to(*joints)))))
    wait(0.4)
    return handle

handle = begun(1.2, 0.0, 0.0)
done(handle.cancel_goal_async())
answer = done(handle.get_result_async())
say(canceled=[answer.status, answer.result.error_code.val], at=now()["joint_1"])
wait(0.3)
say(later=now()["joint_1"])
handle = begun(-1.2, 0.0, 0.0)
events.publish(String(data="stop"))
answer = done(handle.get_result_async())
say(stopped=[answer.status, answer.result.error_code.val])
client = ActionClient(node, ExecuteTrajectory, "/execute_trajectory")
client.wait_for_server()
trajectory = plan(to(0.0, 0.0, 0.0), start=state([1.0, 0.0, 0.0])).trajectory
answer = done(done(client.send_goal_async(ExecuteTrajectory.Goal(trajectory=trajectory))).get_result_async())
say(elsewhere=[answer.status, answer.result.error_code.val])
""",
        3.0,
    )
    assert found["canceled"] == [5, -7]
    assert 0.05 < found["at"] < 1.0
    assert found["later"] == pytest.approx(found["at"], abs=0.02)
    assert found["stopped"] == [6, -7]
    assert found["elsewhere"] == [6, -4]  # it does not begin where the robot is


def test_a_constraint_on_the_way_is_kept(told):
    """The claw's height stays within 2 cm, while the straight way between the joints' positions leaves that."""
    height = claw(0.0, 1.2, -1.2)[2]
    end = asin((0.16 + 0.3 - height) / 0.246)  # at the same height
    halfway = claw(0.0, 0.6, 0.5 * (end - 1.2))[2]
    assert abs(halfway - height) > 0.02
    found = told(
        f"""
region = BoundingVolume()
region.primitives = [SolidPrimitive(type=SolidPrimitive.BOX, dimensions=[4.0, 4.0, 0.04])]
pose = Pose()
pose.position.z, pose.orientation.w = {height}, 1.0
region.primitive_poses = [pose]
limit = PositionConstraint(link_name="claw", constraint_region=region, weight=1.0)
limit.header.frame_id = "base_link"
answer = plan(to({pi / 2}, 0.0, {end}), start=state([0.0, 1.2, -1.2]),
              path_constraints=Constraints(position_constraints=[limit]))
say(code=answer.error_code.val, points=[list(point.positions) for point in answer.trajectory.joint_trajectory.points])
""",
        0.6,
    )
    assert found["code"] == 1
    assert max(abs(claw(*joints)[2] - height) for joints in found["points"]) < 0.0205
