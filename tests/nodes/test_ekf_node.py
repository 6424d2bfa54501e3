"""``robot_localization/ekf_node``, in a twin whose drive does not place its base."""

from math import asin, hypot

import pytest
from node_runs import lines, script

from drake_twin import Twin
from drake_twin.builder.launch_file import launch_file_scenario
from drake_twin.nodes.nodes import Nodes
from drake_twin.scenario import NodeProgram

LAUNCH = """
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node

def generate_launch_description():
    share = get_package_share_directory("rover_navigation")
    simulation = PythonLaunchDescriptionSource(os.path.join(share, "launch", "simulation.launch.py"))
    return LaunchDescription([
        IncludeLaunchDescription(simulation, launch_arguments={{"drive_parameters": {odometry!r}}}.items()),
        Node(package="robot_localization", executable="ekf_node", name="ekf", parameters=[{parameters!r}]),
    ])
"""
ODOMETRY = "/**/drive_controller: {ros__parameters: {enable_odom_tf: false}}\n"
VELOCITIES = "[false, false, false, false, false, false, true, true, false, false, false, true, false, false, false]"
PARAMETERS = f"""/**:
  ros__parameters:
    frequency: 50.0
    two_d_mode: true
    odom_frame: rover_odom
    base_link_frame: rover_base_link
    odom0: /rover/drive_controller/odom
    odom0_config: {VELOCITIES}
"""
DRIVER = """
import rclpy
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.time import Time
from tf2_msgs.msg import TFMessage

class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.drawn, self.parents = {}, []
        self.create_subscription(Odometry, "/rover/drive_controller/odom", self.draw, 10)
        self.create_subscription(Odometry, "/odometry/filtered", self.compare, 10)
        self.create_subscription(TFMessage, "/tf", self.hear, 10)
        self.publisher = self.create_publisher(TwistStamped, "/rover/drive_controller/cmd_vel", 10)
        self.create_timer(0.1, self.drive)

    def drive(self):
        message = TwistStamped()
        message.header.stamp = self.get_clock().now().to_msg()
        message.twist.linear.x, message.twist.angular.z = 0.5, 0.3
        self.publisher.publish(message)

    def draw(self, message):
        self.drawn[Time.from_msg(message.header.stamp).nanoseconds] = message.pose.pose

    def hear(self, message):
        for item in message.transforms:
            if item.child_frame_id == "rover_base_link":
                print("tf", Time.from_msg(item.header.stamp).nanoseconds * 1e-9, item.header.frame_id)

    def compare(self, message):
        own = self.drawn.get(Time.from_msg(message.header.stamp).nanoseconds)
        if own is not None:
            p, q, found = own.position, own.orientation, message.pose.pose
            print("pose", p.x, p.y, q.z, found.position.x, found.position.y, found.orientation.z,
                  message.header.frame_id, message.child_frame_id, message.pose.covariance[0])

rclpy.init()
rclpy.spin(Driver())
"""


def run(folder, parameters, until=3.0, *more):
    odometry = script(folder, "odometry.yaml", ODOMETRY)
    file = script(folder, "ekf.yaml", parameters)
    launch = script(folder, "all.launch.py", LAUNCH.format(odometry=str(odometry), parameters=str(file)))
    scenario = launch_file_scenario(launch).scenario
    driver = NodeProgram(str(script(folder, "driver.py", DRIVER)))
    with Twin(scenario) as twin:
        nodes = Nodes(twin, [*scenario.nodes, driver, *more])
        twin.advance_to(until)
        nodes.close()
        return [item.what for item in twin.more_findings]


def way(poses):
    """How far it is from the first pose to the last one (m), and how much is turned (rad)."""
    (x, y, z), (u, v, w) = poses[0], poses[-1]
    return hypot(u - x, v - y), 2 * (asin(w) - asin(z))


def test_velocities_become_the_drives_own_odometry_and_its_transform(tmp_path, capsys):
    """Both integrate the same velocities; the filter believes the first ones only little by little."""
    assert run(tmp_path, PARAMETERS) == []
    words = [line.split() for line in lines(capsys)]
    poses = [list(map(float, item[1:7])) for item in words if item[0] == "pose"]
    assert len(poses) > 100
    assert {(item[7], item[8]) for item in words if item[0] == "pose"} == {("rover_odom", "rover_base_link")}
    drawn, found = (way([pose[part] for pose in poses[len(poses) // 2 :]]) for part in (slice(3), slice(3, 6)))
    assert drawn == pytest.approx((0.74, 0.45), abs=0.02)  # of 0.5 m/s and 0.3 rad/s for 1.5 s
    assert found == pytest.approx(drawn, rel=2e-3)
    variances = [float(item[9]) for item in words if item[0] == "pose"]
    assert variances == sorted(variances)  # of a position that nothing measures
    parents = [(float(item[1]), item[2]) for item in words if item[0] == "tf"]
    begin = min(time for time, parent in parents if parent == "rover_odom")
    assert {parent for time, parent in parents if time > begin + 0.1} == {"rover_odom"}


def test_a_parameter_of_a_wrong_length_ends_the_node(tmp_path):
    (what,) = run(tmp_path, PARAMETERS.replace(VELOCITIES, "[true]"), 0.1)
    assert "the parameter odom0_config has 1 elements, but 15 are needed" in what


def test_what_is_not_followed_is_a_finding(tmp_path):
    (what,) = run(tmp_path, PARAMETERS + "    use_control: true\n", 0.1)
    assert what.startswith("node robot_localization/ekf_node: the parameter use_control is not followed (")


def test_a_pose_can_be_set(tmp_path, capsys):
    text = """
import rclpy
from geometry_msgs.msg import PoseWithCovarianceStamped
from robot_localization.srv import SetPose, ToggleFilterProcessing

rclpy.init()
node = rclpy.create_node("setter")
client = node.create_client(SetPose, "/set_pose")
client.wait_for_service()
pose = PoseWithCovarianceStamped()
pose.header.frame_id = "rover_odom"
pose.header.stamp = node.get_clock().now().to_msg()
pose.pose.pose.position.x = 40.0
pose.pose.pose.orientation.w = 1.0
rclpy.spin_until_future_complete(node, client.call_async(SetPose.Request(pose=pose)))
toggle = node.create_client(ToggleFilterProcessing, "/toggle")
request = ToggleFilterProcessing.Request(on=False)
for _ in range(2):
    future = toggle.call_async(request)
    rclpy.spin_until_future_complete(node, future)
    print("toggled", future.result().status)
"""
    setter = NodeProgram(str(script(tmp_path, "setter.py", text)), time=1.0)
    assert run(tmp_path, PARAMETERS, 1.2, setter) == []
    said = lines(capsys)
    assert [line for line in said if line.startswith("toggled")] == ["toggled True", "toggled False"]
    assert max(float(line.split()[4]) for line in said if line.startswith("pose")) < 41.0
