"""A checklist for Nav2 and MoveIt of the ROS 2 on this machine: the rover drives through a room, the arm moves.

Run it where ROS 2 is sourced, with Nav2 and MoveIt installed: python diagrams/nav2_and_moveit.py

It starts the twin with `--ros rclpy`, looks at each interface of the robot, starts Nav2 or move_group with the bundled
parameters, and sends them goals. Each line is an interface; the exit code is 0 if all are as they should be. Options
name one part ("nav2", "moveit") and the Python of the twin, where it is not this one (--twin-python).
"""

import argparse
import importlib.util
import math
import os
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

try:
    import rclpy
except ImportError:
    print("error: no rclpy: source a ROS 2 first, as with `source /opt/ros/jazzy/setup.bash`", file=sys.stderr)
    sys.exit(2)
from controller_manager_msgs.srv import ListControllers
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
from rclpy.action import ActionClient
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

MODELS = Path(__file__).resolve().parents[1] / "models"
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
PATIENCE, LONG = 30.0, 180.0  # s: for a topic, and for Nav2 or MoveIt to start and to reach a goal
SIM_TIME = [Parameter("use_sim_time", value=True)]
ACTIVE = ("amcl", "controller_server", "bt_navigator")  # nodes of Nav2
GOAL = (4.2, 0.8)  # m, in the map of the room, behind the pillar
POSES = {"arm": {"joint_1": 0.6, "joint_2": 0.3, "joint_3": -0.4}, "gripper": {"joint_4": 0.5}}  # rad, as in the SRDF
ACTIONS = {"arm": "/joint_trajectory_controller/follow_joint_trajectory", "gripper": "/gripper_controller/gripper_cmd"}


class Checklist:
    """Interfaces that were looked at, with what is heard of topics."""

    def __init__(self, node):
        self.node, self.failed, self.count, self.heard = node, 0, 0, {}

    def listen(self, topic, kind, quality=10):
        """Keep the last message of a topic."""
        self.node.create_subscription(kind, topic, lambda message: self.heard.__setitem__(topic, message), quality)

    def last(self, topic):
        return self.heard.get(topic)

    def check(self, what, condition, patience=None):
        """Wait until an interface is as it should be; say whether it was."""
        end = time.monotonic() + (PATIENCE if patience is None else patience)
        while not (found := condition()) and time.monotonic() < end:
            rclpy.spin_once(self.node, timeout_sec=0.1)
        self.count += 1
        self.failed += not found
        print(f"{'ok  ' if found else 'FAIL'} {what}", flush=True)
        return found

    def call(self, kind, name, request):
        """Call a service; None if it does not answer."""
        client = self.node.create_client(kind, name)
        if not client.wait_for_service(PATIENCE):
            return None
        future = client.call_async(request)
        rclpy.spin_until_future_complete(self.node, future, timeout_sec=PATIENCE)
        return future.result() if future.done() else None


def look_at_the_rover(checklist):
    """What Nav2 takes from a robot: time, transforms, a scan, odometry, and a topic for commands."""
    parents = {}

    def hear_transforms(message):
        parents.update({each.child_frame_id: each.header.frame_id for each in message.transforms})

    node, last = checklist.node, checklist.last
    node.create_subscription(TFMessage, "/tf", hear_transforms, 100)
    static = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(TFMessage, "/tf_static", hear_transforms, static)
    checklist.listen("/clock", Clock, qos_profile_sensor_data)
    checklist.listen("/rover/scan", LaserScan, qos_profile_sensor_data)
    checklist.listen("/rover/drive_controller/odom", Odometry)
    checklist.listen("/rover/ground_truth/odom", Odometry)
    checklist.listen("/rover_robot_description", String, LATCHED)
    checklist.check("/clock advances", lambda: last("/clock") and last("/clock").clock.sec > 0)
    checklist.check("/rover_robot_description is there for who comes late", lambda: last("/rover_robot_description"))

    def leads_to_the_lidar():
        return (parents.get("rover_lidar"), parents.get("rover_base_link")) == ("rover_base_link", "rover_odom")

    checklist.check("/tf leads from rover_odom to rover_base_link and rover_lidar", leads_to_the_lidar)

    def is_scan():
        scan = last("/rover/scan")
        return scan and scan.header.frame_id == "rover_lidar" and len(scan.ranges) == 360

    checklist.check("/rover/scan has 360 rays in rover_lidar, as sensor data", is_scan)

    def is_odometry():
        odometry = last("/rover/drive_controller/odom")
        return odometry and (odometry.header.frame_id, odometry.child_frame_id) == ("rover_odom", "rover_base_link")

    checklist.check("/rover/drive_controller/odom is of rover_base_link in rover_odom", is_odometry)
    drive = "/rover/drive_controller/cmd_vel"
    checklist.check(f"{drive} takes commands", lambda: node.count_subscribers(drive) > 0)
    return parents


def navigate(checklist, parents):
    """A goal of Nav2's own client: reached, by what it says and by where the rover really is."""
    from lifecycle_msgs.srv import GetState
    from nav2_simple_commander.robot_navigator import BasicNavigator, TaskResult

    def pose(x, y):
        made = PoseStamped()
        made.header.frame_id, made.header.stamp = "map", navigator.get_clock().now().to_msg()
        made.pose.position.x, made.pose.position.y, made.pose.orientation.w = x, y, 1.0
        return made

    def is_active(name):
        answer = checklist.call(GetState, f"/{name}/get_state", GetState.Request())
        return answer and answer.current_state.label == "active"

    if not all(checklist.check(f"/{name} is active", lambda name=name: is_active(name), LONG) for name in ACTIVE):
        return
    navigator = BasicNavigator()
    navigator.set_parameters(SIM_TIME)
    navigator.setInitialPose(pose(0.0, 0.0))
    navigator.waitUntilNav2Active()
    checklist.check("amcl places rover_odom in map", lambda: parents.get("rover_odom") == "map")
    navigator.goToPose(pose(*GOAL))
    checklist.check(f"the goal x {GOAL[0]} m, y {GOAL[1]} m ends", navigator.isTaskComplete, LONG)
    checklist.check("it is reached, says Nav2", lambda: navigator.getResult() == TaskResult.SUCCEEDED, 0)

    def is_there():
        place = checklist.last("/rover/ground_truth/odom").pose.pose.position
        return math.hypot(place.x - GOAL[0], place.y - GOAL[1]) < 0.4

    checklist.check("it is reached, says /rover/ground_truth/odom", is_there)


def look_at_the_arm(checklist):
    """What MoveIt takes from a robot: time, its description, joint states, controllers and their actions."""
    from control_msgs.action import FollowJointTrajectory, GripperCommand

    node, last = checklist.node, checklist.last
    checklist.listen("/clock", Clock, qos_profile_sensor_data)
    checklist.listen("/robot_description", String, LATCHED)
    checklist.listen("/joint_states", JointState)
    checklist.check("/clock advances", lambda: last("/clock") and last("/clock").clock.sec > 0)
    checklist.check("/robot_description is there for who comes late", lambda: last("/robot_description"))
    joints = {f"joint_{number}" for number in range(1, 6)}
    known = "/joint_states has all joints, the mimic one among them"
    checklist.check(known, lambda: last("/joint_states") and joints <= set(last("/joint_states").name))
    listed = checklist.call(ListControllers, "/controller_manager/list_controllers", ListControllers.Request())
    active = {each.name for each in listed.controller if each.state == "active"} if listed else set()
    wanted = {"joint_state_broadcaster", "joint_trajectory_controller", "gripper_controller"}
    checklist.check("list_controllers has three active controllers", lambda: active == wanted, 0)
    for group, kind in (("arm", FollowJointTrajectory), ("gripper", GripperCommand)):
        client = ActionClient(node, kind, ACTIONS[group])
        checklist.check(f"{ACTIONS[group]} is an action", lambda client=client: client.server_is_ready())


def move(checklist):
    """Goals of move_group: planned, executed, and the joints are where they should be."""
    from moveit_msgs.action import MoveGroup
    from moveit_msgs.msg import Constraints, JointConstraint, MoveItErrorCodes

    client = ActionClient(checklist.node, MoveGroup, "/move_action")
    if not checklist.check("/move_action is there", client.server_is_ready, LONG):
        return
    for group, wanted in POSES.items():
        goal = MoveGroup.Goal()
        goal.request.group_name, goal.request.num_planning_attempts = group, 5
        goal.request.allowed_planning_time = 5.0
        goal.request.max_velocity_scaling_factor = goal.request.max_acceleration_scaling_factor = 0.5
        constraints = [
            JointConstraint(joint_name=name, position=at, tolerance_above=0.005, tolerance_below=0.005, weight=1.0)
            for name, at in wanted.items()
        ]
        goal.request.goal_constraints = [Constraints(joint_constraints=constraints)]
        sent = client.send_goal_async(goal)
        if not checklist.check(
            f"{group}: the goal is accepted", lambda sent=sent: sent.done() and sent.result().accepted
        ):
            continue
        future = sent.result().get_result_async()
        checklist.check(f"{group}: it ends", future.done, LONG)
        code = future.result().result.error_code.val if future.done() else 0
        checklist.check(
            f"{group}: planned and executed, says MoveIt", lambda code=code: code == MoveItErrorCodes.SUCCESS, 0
        )

        def is_there(wanted=wanted):
            states = checklist.last("/joint_states")
            at = dict(zip(states.name, states.position, strict=True))
            return all(abs(at[name] - value) < 0.02 for name, value in wanted.items())

        checklist.check(f"{group}: it is there, says /joint_states", is_there)


@contextmanager
def running(*command, environment):
    """Another program beside the checklist; it ends with its own processes."""
    process = subprocess.Popen(command, env=environment, start_new_session=True)
    try:
        yield
    finally:
        os.killpg(process.pid, signal.SIGINT)
        try:
            process.wait(30)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def with_models(folder):
    """The environment in which ROS finds the bundled packages, as if they were installed in this folder."""
    share = Path(folder) / "share"
    index = share / "ament_index" / "resource_index" / "packages"
    index.mkdir(parents=True)
    for package in MODELS.iterdir():
        (index / package.name).touch()
        (share / package.name).symlink_to(package)
    found = os.environ.get("AMENT_PREFIX_PATH", "")
    return {**os.environ, "AMENT_PREFIX_PATH": os.pathsep.join((folder, *filter(None, (found,))))}


PARTS = {
    "nav2": ("rover_navigation", "navigation.launch.py", look_at_the_rover, navigate),
    "moveit": ("arduinobot_moveit_config", "move_group.launch.py", look_at_the_arm, lambda list_, _: move(list_)),
}
PACKAGES = {"nav2": "nav2_simple_commander", "moveit": "moveit_msgs"}


def run_part(part, python):
    """Check one part; return how many interfaces failed, and of how many."""
    package, launch, look, use = PARTS[part]
    folder = MODELS / package / "launch"
    options = ("--headless", "--ros", "rclpy", "--clock-rate", "100")
    node = rclpy.create_node("checklist", parameter_overrides=SIM_TIME)
    checklist = Checklist(node)
    print(f"--- {part}: {package}", flush=True)
    with tempfile.TemporaryDirectory() as prefix:
        environment = with_models(prefix)
        twin = (python, "-m", "drake_twin.run", str(folder / "simulation.launch.py"), *options)
        with running(*twin, environment=dict(os.environ)):
            found = look(checklist)
            with running("ros2", "launch", str(folder / launch), environment=environment):
                use(checklist, found)
    node.destroy_node()
    return checklist.failed, checklist.count


def check_packages(parts):
    """End with a paragraph where a part's package is missing."""
    lacking = [PACKAGES[part] for part in parts if importlib.util.find_spec(PACKAGES[part]) is None]
    if lacking:
        debs = " ".join(f"ros-{os.environ.get('ROS_DISTRO', 'DISTRO')}-{each.replace('_', '-')}" for each in lacking)
        print(f"error: this ROS 2 lacks {', '.join(lacking)}: `sudo apt install {debs}`", file=sys.stderr)
        sys.exit(2)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)}; all by default")
    parser.add_argument("--twin-python", default=sys.executable, help="the Python that drake_twin is installed for")
    arguments = parser.parse_args()
    if unknown := set(arguments.parts) - set(PARTS):
        parser.error(f"unknown part {', '.join(sorted(unknown))}; valid: {', '.join(PARTS)}")
    check_packages(arguments.parts or PARTS)
    rclpy.init()
    results = [run_part(part, arguments.twin_python) for part in arguments.parts or PARTS]
    failed, count = map(sum, zip(*results, strict=True))
    print(f"{count - failed} of {count} are as they should be")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
