"""A program that does a whole job in water: it dives, holds its depth and drives to a place, by its thrusters."""

from math import hypot

import pytest
from node_runs import script
from waters import SEA, box, hydrodynamics, thruster

from drake_twin import TwinBuilder

# Name → where it is on the hull, and the axis of its thrust there.
PROPELLERS = {
    "left": ("-0.4 0.2 0", "1 0 0"),
    "right": ("-0.4 -0.2 0", "1 0 0"),
    "front": ("0.3 0 0.1", "0 0 1"),
    "rear": ("-0.3 0 0.1", "0 0 1"),
}
PROPELLER = """<link name="{name}"><pose>{place} 0 0 0</pose><inertial><mass>0.05</mass><inertia><ixx>1e-4</ixx>
<iyy>1e-4</iyy><izz>1e-4</izz></inertia></inertial></link><joint name="{name}_joint" type="revolute">
<parent>hull</parent><child>{name}</child><axis><xyz>{axis}</xyz><limit><lower>-1e16</lower><upper>1e16</upper></limit>
</axis></joint>"""
DAMPING = {"xU": -10, "yV": -60, "zW": -20, "kP": -3, "mQ": -3, "nR": -15, "xUabsU": -18, "yVabsV": -30, "zWabsW": -40}
ADDED_MASS = {"xDotU": -6, "yDotV": -12, "zDotW": -15, "nDotR": -0.2}
ODOMETRY = """<plugin filename="gz-sim-odometry-publisher-system" name="gz::sim::systems::OdometryPublisher">
<dimensions>3</dimensions></plugin>"""
LAUNCH = """
from launch import LaunchDescription
from launch.actions import ExecuteProcess
from launch_ros.actions import Node

PROPELLERS = {names!r}

def generate_launch_description():
    topics = [f"/model/rov/joint/{{name}}_joint/cmd_thrust" for name in PROPELLERS]
    bridge = Node(
        package="ros_gz_bridge",
        executable="parameter_bridge",
        arguments=[
            "/model/rov/odometry@nav_msgs/msg/Odometry[gz.msgs.Odometry",
            *(topic + "@std_msgs/msg/Float64]gz.msgs.Double" for topic in topics),
        ],
        remappings=[
            ("/model/rov/odometry", "/odometry"),
            *((topic, f"/thrusters/{{name}}") for topic, name in zip(topics, PROPELLERS)),
        ],
    )
    pilot = ExecuteProcess(cmd=["python3", {pilot!r}, "--ros-args", "-p", "depth:=2.0", "-p", "goal:=[3.0, -2.0]"])
    return LaunchDescription([ExecuteProcess(cmd=["gz", "sim", "-r", {world!r}]), bridge, pilot])
"""
PILOT = """
from math import atan2, cos, hypot, pi

import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Float64


class Pilot(Node):
    '''Holds a depth by two propellers, and steers to a place by two others.'''

    def __init__(self):
        super().__init__("pilot")
        self.declare_parameter("depth", 0.0)
        self.declare_parameter("goal", [0.0, 0.0])
        self.depth, self.goal = self.get_parameter("depth").value, self.get_parameter("goal").value
        self.odometry, self.sum = None, 0.0
        self.create_subscription(Odometry, "odometry", self.hear, 10)
        names = ("left", "right", "front", "rear")
        self.thrusters = {name: self.create_publisher(Float64, f"thrusters/{name}", 10) for name in names}
        self.create_timer(0.05, self.steer)

    def hear(self, message):
        self.odometry = message

    def steer(self):
        if self.odometry is None:
            return
        place, turn = self.odometry.pose.pose.position, self.odometry.pose.pose.orientation
        motion = self.odometry.twist.twist
        low = -self.depth - place.z
        self.sum = max(-3.0, min(3.0, self.sum + 0.05 * low))
        lift = 30.0 * low + 5.0 * self.sum - 60.0 * motion.linear.z
        yaw = atan2(2 * (turn.w * turn.z + turn.x * turn.y), 1 - 2 * (turn.y**2 + turn.z**2))
        x, y = self.goal[0] - place.x, self.goal[1] - place.y
        angle = (atan2(y, x) - yaw + pi) % (2 * pi) - pi
        push = max(-40.0, min(40.0, 20.0 * hypot(x, y) * cos(angle))) - 60.0 * motion.linear.x
        twist = (40.0 * angle if hypot(x, y) > 0.3 else 0.0) - 4.0 * motion.angular.z
        for name, thrust in (
            ("left", push / 2 - twist), ("right", push / 2 + twist), ("front", lift / 2), ("rear", lift / 2)
        ):
            self.thrusters[name].publish(Float64(data=max(-30.0, min(30.0, thrust))))


rclpy.init()
rclpy.spin(Pilot())
"""


@pytest.fixture
def launch(tmp_path):
    parts = "".join(PROPELLER.format(name=name, place=place, axis=axis) for name, (place, axis) in PROPELLERS.items())
    plugins = [thruster(f"{name}_joint", namespace="rov", velocity_control=1) for name in PROPELLERS]
    rov = box(
        "rov",
        (0.8, 0.4, 0.3),
        985.0,
        "0 0 -0.5 0 0 0.5",
        low=0.03,
        more=parts + "".join(plugins) + hydrodynamics(**DAMPING, **ADDED_MASS) + ODOMETRY,
    )
    physics = "<physics type='ode'><max_step_size>0.02</max_step_size></physics>"
    world = script(tmp_path, "sea.sdf", f'<sdf version="1.9"><world name="sea">{physics}{SEA}{rov}</world></sdf>')
    pilot = script(tmp_path, "pilot.py", PILOT)
    return script(tmp_path, "sea.launch.py", LAUNCH.format(names=[*PROPELLERS], pilot=str(pilot), world=str(world)))


def test_a_vehicle_dives_and_drives_to_a_place_and_does_so_again_to_the_bit(launch):
    hashes = []
    for _ in range(2):
        with TwinBuilder().launch(launch).build() as twin:
            assert not [finding for finding in twin.findings if "not started" in str(finding)]
            for time in (17.0, 20.0):
                twin.advance_to(time)
                state = twin.entities.state("rov")
                x, y, z = state.position
                assert z == pytest.approx(-2.0, abs=0.05)
                assert hypot(3.0 - x, -2.0 - y) < 0.1
            assert max(map(abs, state.linear)) < 0.01
            hashes.append(twin.state_sha256())
    assert hashes[0] == hashes[1]
