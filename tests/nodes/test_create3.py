"""The nodes of a Create 3, on the bundled rover: goals that drive it, limits of velocity, lights."""

import json

import pytest
from interface_packages import write_package
from node_runs import script
from program_runs import MODELS

from drake_twin import TwinBuilder

_GOAL = "geometry_msgs/PoseStamped pose\n---\n"
_TIME = "builtin_interfaces/Duration"
_RUNTIME = f"{_TIME} max_runtime\n---\n{_TIME} runtime\n---\n{_TIME} remaining_runtime\n"
PACKAGE = {
    "msg": {
        "LedColor": "uint8 red\nuint8 green\nuint8 blue\n",
        "LightringLeds": "std_msgs/Header header\nLedColor[6] leds\nbool override_system\n",
        "AudioNote": "uint16 frequency\nbuiltin_interfaces/Duration max_runtime\n",
        "AudioNoteVector": "std_msgs/Header header\nAudioNote[] notes\nbool append\n",
        "Button": "std_msgs/Header header\nbool is_pressed\n",
        "InterfaceButtons": "std_msgs/Header header\nButton button_1\nButton button_power\nButton button_2\n",
        "WheelStatus": "std_msgs/Header header\nbool wheels_enabled\n",
    },
    "srv": {
        "EStop": "bool e_stop_on\n---\nbool success\nstring message\n",
        "RobotPower": "---\nbool success\nstring message\n",
    },
    "action": {
        "DriveDistance": f"float32 distance\nfloat32 max_translation_speed 0.3\n---\n{_GOAL}"
        "float32 remaining_travel_distance\n",
        "RotateAngle": f"float32 angle\nfloat32 max_rotation_speed 1.9\n---\n{_GOAL}float32 remaining_angle_travel\n",
        "DriveArc": "int8 TRANSLATE_FORWARD = 1\nint8 TRANSLATE_BACKWARD = -1\nint8 translate_direction\n"
        "float32 angle\nfloat32 radius\nfloat32 max_translation_speed 0.3\n---\n"
        f"{_GOAL}float32 remaining_angle_travel\n",
        "NavigateToPosition": "geometry_msgs/PoseStamped goal_pose\nbool achieve_goal_heading\n"
        f"float32 max_translation_speed 0.3\nfloat32 max_rotation_speed 1.9\n---\n{_GOAL}int8 navigate_state\n"
        "float32 remaining_angle_travel\nfloat32 remaining_travel_distance\n",
        "LedAnimation": f"int8 animation_type\nLightringLeds lightring\n{_RUNTIME}",
        "AudioNoteSequence": "int32 iterations 1\nAudioNoteVector note_sequence\n---\nbool complete\n"
        "int32 iterations_played\nbuiltin_interfaces/Duration runtime\n---\nint32 iterations_played\n"
        "builtin_interfaces/Duration current_runtime\n",
    },
}
LAUNCH = f"""
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch_ros.actions import Node

def generate_launch_description():
    topics = [("diffdrive_controller/cmd_vel", "drive_controller/cmd_vel"), ("odom", "drive_controller/odom")]
    robot = {str(MODELS / "rover_navigation" / "launch" / "simulation.launch.py")!r}
    return LaunchDescription([
        IncludeLaunchDescription(robot),
        Node(package="irobot_create_nodes", executable="motion_control", namespace="rover", remappings=topics),
        Node(package="irobot_create_nodes", executable="ui_mgr", namespace="rover"),
    ])
"""
HEAD = """
import json
from math import atan2
import rclpy
from geometry_msgs.msg import Twist
from irobot_create_msgs.action import DriveArc, DriveDistance, LedAnimation, NavigateToPosition, RotateAngle
from irobot_create_msgs.msg import LightringLeds
from irobot_create_msgs.srv import EStop
from nav_msgs.msg import Odometry
from rcl_interfaces.srv import SetParameters
from rclpy.action import ActionClient
from rclpy.parameter import Parameter

rclpy.init()
node = rclpy.create_node("client", namespace="rover")
heard = []
node.create_subscription(Odometry, "drive_controller/odom", lambda item: heard.append(item), 10)
velocities = node.create_publisher(Twist, "cmd_vel", 10)
lights = node.create_publisher(LightringLeds, "cmd_lightring", 10)

def done(future):
    rclpy.spin_until_future_complete(node, future)
    return future.result()

def wait(seconds, twist=None):
    end = node.get_clock().now().nanoseconds + seconds * 1e9
    while node.get_clock().now().nanoseconds < end:
        if twist is not None:
            velocities.publish(twist)
        rclpy.spin_once(node, timeout_sec=0.02)

def at():
    pose = heard[-1].pose.pose
    return [pose.position.x, pose.position.y, 2 * atan2(pose.orientation.z, pose.orientation.w)]

def speed(x, z=0.0):
    twist = Twist()
    twist.linear.x, twist.angular.z = x, z
    wait(0.6, twist)
    return [heard[-1].twist.twist.linear.x, heard[-1].twist.twist.angular.z]

def begun(kind, name, goal, feedback=None):
    client = ActionClient(node, kind, name)
    client.wait_for_server()
    return done(client.send_goal_async(goal, feedback))

def ended(handle):
    answer = done(handle.get_result_async())
    wait(0.3)
    return answer

def say(**values):
    print(json.dumps(values), flush=True)

wait(0.3)
"""


@pytest.fixture
def told(tmp_path, capsys):
    """Returns what a client says: the lines of JSON that it prints, as one dictionary."""

    def run(text, seconds):
        source = tmp_path / "src"
        write_package(source, "irobot_create_msgs", **PACKAGE)
        launch = script(source, "both.launch.py", LAUNCH)
        builder = TwinBuilder().package_path(source).launch(launch)
        with builder.node(script(source, "client.py", HEAD + text)).build() as twin:
            twin.advance_to(seconds)
            assert any("dock, undock and wall_follow" in str(item) for item in twin.findings)
        lines = capsys.readouterr().out.splitlines()
        return {name: value for line in lines if line[:1] == "{" for name, value in json.loads(line).items()}

    return run


def test_goals_drive_the_robot(told):
    found = told(
        """
left = []
answer = ended(begun(DriveDistance, "drive_distance", DriveDistance.Goal(distance=0.4),
                     lambda item: left.append(item.feedback.remaining_travel_distance)))
say(straight=[answer.status, *at()], left=left)
goal = RotateAngle.Goal(angle=1.2, max_rotation_speed=0.8)
say(turned=[ended(begun(RotateAngle, "rotate_angle", goal)).status, *at()])
goal = NavigateToPosition.Goal(achieve_goal_heading=True, max_rotation_speed=0.8)
goal.goal_pose.pose.position.x, goal.goal_pose.pose.orientation.w = 0.1, 1.0
say(there=[ended(begun(NavigateToPosition, "navigate_to_position", goal)).status, *at()])
handle = begun(DriveDistance, "drive_distance", DriveDistance.Goal(distance=2.0))
wait(0.5)
other = begun(RotateAngle, "rotate_angle", RotateAngle.Goal(angle=1.0))
done(handle.cancel_goal_async())
say(second=other.accepted, canceled=ended(handle).status, x=at()[0], still=speed(0.0))
""",
        30.0,
    )
    assert found["straight"] == [
        4,
        pytest.approx(0.4, abs=0.02),
        pytest.approx(0.0, abs=0.02),
        pytest.approx(0.0, abs=0.05),
    ]
    assert found["left"] == sorted(found["left"], reverse=True)
    assert 0.3 < found["left"][0] <= 0.4
    assert found["turned"][0] == 4
    assert found["turned"][3] == pytest.approx(1.2, abs=0.05)
    assert found["there"][0] == 4
    assert found["there"][1:3] == pytest.approx([0.1, 0.0], abs=0.05)
    assert found["there"][3] == pytest.approx(0.0, abs=0.1)
    assert (found["second"], found["canceled"]) == (False, 5)
    assert 0.1 < found["x"] < 0.6
    assert found["still"] == pytest.approx([0.0, 0.0], abs=0.02)


def test_velocities_are_limited_and_stop_by_themselves(told):
    found = told(
        """
client = node.create_client(SetParameters, "motion_control/set_parameters")
client.wait_for_service()
def mode(value, name="safety_override"):
    parameters = [Parameter(name, value=value).to_parameter_msg()]
    return done(client.call_async(SetParameters.Request(parameters=parameters))).results[0].successful

say(fast=speed(1.0), backwards=speed(-0.2))
wait(1.2)
say(alone=speed(0.0)[0], later=[heard[-1].twist.twist.linear.x])
wait(0.3)
say(full=mode("full"), speed=mode(0.4, "max_speed"), wrong=mode("none at all"))
say(faster=speed(1.0))
stop = node.create_client(EStop, "e_stop")
stop.wait_for_service()
say(stopped=done(stop.call_async(EStop.Request(e_stop_on=True))).success, held=speed(0.3))
say(lights=lights.get_subscription_count())
goal = LedAnimation.Goal(animation_type=1)
goal.max_runtime.sec = 1
answer = ended(begun(LedAnimation, "led_animation", goal))
say(animation=[answer.status, answer.result.runtime.sec])
""",
        12.0,
    )
    assert found["fast"] == pytest.approx([0.306, 0.0], abs=0.01)
    assert found["backwards"][0] > -0.21
    assert found["alone"] == pytest.approx(0.0, abs=0.02)
    assert (found["full"], found["speed"], found["wrong"]) == (True, False, False)
    assert found["faster"] == pytest.approx([0.46, 0.0], abs=0.01)
    assert (found["stopped"], found["held"]) == (True, pytest.approx([0.0, 0.0], abs=0.02))
    assert found["lights"] == 1
    assert found["animation"] == [4, 1]


def test_without_its_messages_a_node_does_nothing(tmp_path):
    launch = script(tmp_path, "both.launch.py", LAUNCH)
    with TwinBuilder().launch(launch).build() as twin:
        twin.advance_to(0.1)
        found = [str(item) for item in twin.findings if "irobot_create_msgs" in str(item)]
    assert len(found) == 2
    assert "it does nothing, as the package irobot_create_msgs is not in the workspace" in found[0]
