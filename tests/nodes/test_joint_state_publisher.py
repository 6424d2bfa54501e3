"""``joint_state_publisher``, against its source: ros/joint_state_publisher, branch ros2, joint_state_publisher.py."""

import pytest
from conftest import rovers
from node_runs import script

from drake_twin.builder.launch_file import launch_file_scenario
from drake_twin.findings import Kind
from drake_twin.nodes.nodes import Nodes
from drake_twin.scenario import NodeProgram

LIMIT = "<limit lower='-1' upper='1' effort='1' velocity='1'/>"
JOINTS = f"""
<joint name='arm' type='revolute'>{LIMIT}</joint>
<joint name='fixed' type='fixed'/>
<joint name='wheel' type='continuous'/>
<joint name='high' type='prismatic'><limit lower='1' upper='3'/></joint>
<joint name='soft' type='prismatic'><limit lower='-1' upper='3'/>
  <safety_controller soft_lower_limit='2' k_velocity='1'/></joint>
<joint name='left' type='prismatic'>{LIMIT}<mimic joint='right' multiplier='2' offset='0.5'/></joint>
<joint name='right' type='prismatic'>{LIMIT}<mimic joint='arm' multiplier='-3' offset='1'/></joint>
"""
SOURCE = """
import rclpy
from sensor_msgs.msg import JointState

rclpy.init()
node = rclpy.create_node("source")
publisher = node.create_publisher(JointState, "/half", 10)
message = JointState(name=["arm", "unknown"], position=[0.25, 9.0], velocity=[2.0], effort=[3.0, 4.0])
node.create_timer(0.1, lambda: publisher.publish(message))
rclpy.spin(node)
"""
EAR = """
import rclpy
from sensor_msgs.msg import JointState

rclpy.init()
node = rclpy.create_node("ear")

def hear(message):
    values = [[round(value, 6) for value in field] for field in (message.position, message.velocity, message.effort)]
    print(f"{message.header.stamp.nanosec / 1e9:.3f} {message.name} {values}", flush=True)

node.create_subscription(JointState, "/out", hear, 10)
rclpy.spin(node)
"""


def heard(tmp_path, capfd, joints, *parameters, seconds=0.35):
    """The lines of the ear, and the findings of the run."""
    (tmp_path / "robot.urdf").write_text(f"<robot name='r'>{joints}</robot>")
    given = [word for parameter in parameters for word in ("-p", parameter)]
    arguments = (str(tmp_path / "robot.urdf"), "--ros-args", "-r", "joint_states:=/out", *given)
    ear, source = script(tmp_path, "ear.py", EAR), script(tmp_path, "source.py", SOURCE)
    programs = [
        NodeProgram("joint_state_publisher", "joint_state_publisher", arguments),
        NodeProgram(str(ear)),
        NodeProgram(str(source)),
    ]
    with rovers(1, time_step=0.01).build() as twin:
        nodes = Nodes(twin, programs)
        twin.advance_to(seconds)
        nodes.close()
        findings = [item.what for item in twin.more_findings]
    return capfd.readouterr().out.splitlines(), findings


def test_each_joint_has_its_zero_and_those_that_follow_others_their_place(tmp_path, capfd):
    """Lines 266 (zeros), 244 (soft limits) and 512 (chains of joints): 0, 0, the middles, 2 (1) + 0.5, 1."""
    lines, findings = heard(tmp_path, capfd, JOINTS)
    assert findings == []
    names = ["arm", "wheel", "high", "soft", "left", "right"]
    assert lines == [f"{time} {names} [[0.0, 0.0, 2.0, 2.5, 2.5, 1.0], [], []]" for time in ("0.100", "0.200", "0.300")]


def test_zeros_and_rate_are_parameters(tmp_path, capfd):
    parameters = "zeros.arm:=0.5", "rate:=20", "use_mimic_tags:=false", "publish_default_velocities:=true"
    lines, _ = heard(tmp_path, capfd, JOINTS, *parameters)
    assert len(lines) == 6
    assert lines[0].endswith("[[0.5, 0.0, 2.0, 2.5, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 0.0], []]")


def test_sources_give_what_they_have(tmp_path, capfd):
    """Lines 432 (sources) and 531 (efforts): 0.25, then 1 - 3 × 0.25 and 0.5 + 2 × 0.25; an effort has no factor."""
    lines, _ = heard(tmp_path, capfd, JOINTS, "source_list:=['/half']")
    wanted = "[[0.25, 0.0, 2.0, 2.5, 1.0, 0.25], [2.0, 0.0, 0.0, 0.0, -12.0, -6.0], [3.0, 0.0, 0.0, 0.0, 3.0, 3.0]]"
    assert lines[-1].endswith(wanted)


@pytest.mark.parametrize(
    ("joints", "parameter", "reason"),
    [
        (JOINTS, "delta:=0.1", "the parameter delta is not supported"),
        ("<joint name='a' type='revolute'/>", "rate:=10", 'Limits must be specified for joint "a" of type "revolute"'),
        (
            "<joint name='a' type='revolute'><limit lower='0'/></joint>",
            "rate:=10",
            '"upper" limit must be specified for joint "a" of type "revolute"',
        ),
        (
            f"<joint name='a' type='revolute'>{LIMIT}<mimic joint='a'/></joint>",
            "rate:=10",
            "Found an infinite recursive mimic chain: ['a', 'a']",
        ),
        (f"<joint name='a' type='revolute'>{LIMIT}<mimic joint='b'/></joint>", "rate:=10", "joint 'a' follows 'b'"),
    ],
)
def test_what_it_cannot_publish_is_said(tmp_path, capfd, joints, parameter, reason):
    _, (finding,) = heard(tmp_path, capfd, joints, parameter, seconds=0.1)
    assert reason in finding


LAUNCH = """
from launch import LaunchDescription
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{{"robot_description": open({urdf!r}).read()}}]),
        Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description", "-name", "r"]),
        Node(package="joint_state_publisher", executable="joint_state_publisher"),
        Node(package="joint_state_publisher", executable="joint_state_publisher", namespace="merged",
             parameters=[{{"source_list": ["/joint_states"]}}]),
        Node(package="teleop_twist_keyboard", executable="teleop_twist_keyboard"),
    ])
"""


def test_a_launch_file_starts_one_whose_topic_is_not_that_of_a_simulated_robot(tmp_path):
    inertia = "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
    urdf = f"<robot name='r'><link name='base'><inertial><mass value='1'/>{inertia}</inertial></link></robot>"
    (tmp_path / "r.urdf").write_text(urdf)
    (tmp_path / "all.launch.py").write_text(LAUNCH.format(urdf=str(tmp_path / "r.urdf")))
    scenario = launch_file_scenario(tmp_path / "all.launch.py").scenario
    (program,) = scenario.nodes
    assert program.executable == "joint_state_publisher"
    assert "__ns:=/merged" in program.arguments
    teleop = "teleop_twist_keyboard"
    assert [item.what for item in scenario.findings if item.kind is Kind.NOT_STARTED] == [
        "joint_state_publisher/joint_state_publisher (joint states come from the simulation)",
        f"{teleop}/{teleop} (it needs a terminal: --node '{teleop} {teleop}')",
    ]
