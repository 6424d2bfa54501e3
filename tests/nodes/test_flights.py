"""A program of the kind that people publish flies a quadcopter of gz-sim's systems, which a launch file brings."""

from math import hypot

import pytest
from multicopters import quadcopter
from node_runs import script

from drake_twin import TwinBuilder

GROUND = """<model name="ground"><static>true</static><link name="l"><collision name="c"><geometry><plane>
<normal>0 0 1</normal><size>50 50</size></plane></geometry></collision></link></model>"""
FEET = """<collision name="feet"><geometry><box><size>0.4 0.4 0.1</size></box></geometry></collision></link>"""
ODOMETRY = """<pose>0 0 0.05 0 0 0</pose><plugin filename="gz-sim-odometry-publisher-system"
name="gz::sim::systems::OdometryPublisher"><dimensions>3</dimensions></plugin></model>"""
LAUNCH = """
from launch import LaunchDescription
from launch.actions import ExecuteProcess
from launch_ros.actions import Node

def generate_launch_description():
    topics = [
        "/X3/command/twist@geometry_msgs/msg/Twist]gz.msgs.Twist",
        "/model/x3/odometry@nav_msgs/msg/Odometry[gz.msgs.Odometry",
    ]
    names = [("/X3/command/twist", "/cmd_vel"), ("/model/x3/odometry", "/odom")]
    return LaunchDescription([
        ExecuteProcess(cmd=["gz", "sim", "-r", {world!r}]),
        Node(package="ros_gz_bridge", executable="parameter_bridge", arguments=topics, remappings=names),
    ])
"""
PILOT = """
import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node

CORNERS = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 0.0)]


class Pilot(Node):
    '''Climbs to 1 m, is at a corner of a square each 5 s, and lands.'''

    def __init__(self):
        super().__init__("pilot")
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Odometry, "odom", self.fly, 10)

    def fly(self, odometry):
        time = self.get_clock().now().nanoseconds * 1e-9
        here, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
        yaw = 2 * math.atan2(turn.z, turn.w)
        x, y = CORNERS[min(int(time / 5.0), len(CORNERS) - 1)]
        command = Twist()
        north, west = (self.limited(1.5 * gap) for gap in (x - here.x, y - here.y))
        command.linear.x = math.cos(yaw) * north + math.sin(yaw) * west
        command.linear.y = math.cos(yaw) * west - math.sin(yaw) * north
        command.linear.z = self.limited(1.0 - here.z) if time < 25.0 else -0.3
        self.publisher.publish(command)

    def limited(self, speed):
        return max(-1.0, min(1.0, speed))


rclpy.init()
rclpy.spin(Pilot())
"""


def flight(folder):
    x3 = quadcopter(controlled=True).replace("</link>", FEET, 1).replace("</model>", ODOMETRY)
    model = x3[x3.index("<model") : x3.rindex("</sdf>")]
    step = '<physics name="p" type="ignored"><max_step_size>0.004</max_step_size></physics>'
    text = f'<sdf version="1.9"><world name="field">{step}{GROUND}{model}</world></sdf>'
    launch = script(folder, "field.launch.py", LAUNCH.format(world=str(script(folder, "field.sdf", text))))
    return TwinBuilder().launch(launch).node(script(folder, "pilot.py", PILOT)).build()


def test_a_quadcopter_takes_off_flies_a_square_by_its_odometry_and_lands(tmp_path):
    with flight(tmp_path / "once") as twin:
        hashes = []
        for corner, (x, y) in enumerate([(0, 0), (2, 0), (2, 2), (0, 2), (0, 0)], start=1):
            twin.advance_to(5.0 * corner)
            hashes.append(twin.state_sha256())
            here = twin.entities.state("x3").position
            assert hypot(here[0] - x, here[1] - y) < 0.1
            assert here[2] == pytest.approx(1.0, abs=0.1)
        twin.advance_to(30.0)
        assert twin.entities.state("x3").position[2] == pytest.approx(0.05, abs=0.01)
        assert twin.findings == ()
    with flight(tmp_path / "again") as twin:
        twin.advance_to(10.0)
        assert twin.state_sha256() == hashes[1]
