"""Programs that do a whole job in the twin, of the kinds that people publish: a ball is followed, keys and a joystick
steer, each with its robot."""

import json
import os
import pty
import subprocess
import sys
from math import hypot

import pytest
from node_runs import COMMANDS, lines, script
from program_runs import ROVER

from drake_twin import TwinBuilder

CART = """<sdf version="1.9"><world name="field">
<model name="ground"><static>true</static><link name="l"><collision name="c"><geometry><plane><normal>0 0 1</normal>
<size>50 50</size></plane></geometry></collision></link></model>
<model name="ball"><static>true</static><pose>2 1 0.12 0 0 0</pose><link name="l"><visual name="v"><geometry><sphere>
<radius>0.12</radius></sphere></geometry><material><diffuse>1 1 0 1</diffuse></material></visual></link></model>
<model name="cart"><pose>0 0 0.1 0 0 0</pose><link name="base"><inertial><mass>4</mass><inertia><ixx>0.05</ixx>
<iyy>0.05</iyy><izz>0.05</izz></inertia></inertial><collision name="c"><geometry><box><size>0.3 0.2 0.1</size></box>
</geometry></collision><collision name="caster"><pose>-0.12 0 -0.07 0 0 0</pose><geometry><sphere><radius>0.03</radius>
</sphere></geometry><surface><friction><ode><mu>0.01</mu></ode></friction></surface></collision>
<sensor name="eye" type="camera"><pose>0.16 0 0.05 0 0 0</pose><update_rate>5</update_rate><topic>image</topic><camera>
<horizontal_fov>1.0</horizontal_fov><image><width>80</width><height>60</height></image><clip><near>0.05</near>
<far>20</far></clip></camera></sensor></link>
WHEELS
<plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive"><left_joint>left_joint</left_joint>
<right_joint>right_joint</right_joint><wheel_separation>0.26</wheel_separation><wheel_radius>0.06</wheel_radius>
<topic>cmd_vel</topic></plugin></model></world></sdf>
"""
WHEEL = """<link name="{name}"><pose>0.08 {y} -0.04 -1.5708 0 0</pose><inertial><mass>0.3</mass><inertia>
<ixx>0.0005</ixx><iyy>0.0005</iyy><izz>0.0005</izz></inertia></inertial><collision name="c"><geometry><cylinder>
<radius>0.06</radius><length>0.03</length></cylinder></geometry></collision></link>
<joint name="{name}_joint" type="revolute">
<parent>base</parent><child>{name}</child><axis><xyz>0 0 1</xyz></axis></joint>"""
LAUNCH = """
from launch import LaunchDescription
from launch.actions import ExecuteProcess
from launch_ros.actions import Node

def generate_launch_description():
    topics = ["/cmd_vel@geometry_msgs/msg/Twist]gz.msgs.Twist", "/image@sensor_msgs/msg/Image[gz.msgs.Image"]
    return LaunchDescription([
        ExecuteProcess(cmd=["gz", "sim", "-r", {world!r}]),
        Node(package="ros_gz_bridge", executable="parameter_bridge", arguments=topics),
    ])
"""
FOLLOWER = """
import rclpy
from cv_bridge import CvBridge
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import Image


class Follower(Node):
    '''Turns until it sees something yellow, then drives there until it is large.'''

    def __init__(self):
        super().__init__("follower")
        self.bridge, self.seen, self.time = CvBridge(), None, None
        self.create_subscription(Image, "image", self.look, rclpy.qos.qos_profile_sensor_data)
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_timer(0.1, self.drive)

    def look(self, message):
        image = self.bridge.imgmsg_to_cv2(message, "rgb8").astype(int)
        yellow = (image[:, :, 0] > 120) & (image[:, :, 1] > 120) & (image[:, :, 2] < 90)
        if yellow.sum() > 3:
            columns = yellow.nonzero()[1]
            self.seen = 2 * columns.mean() / image.shape[1] - 1, (columns.max() - columns.min() + 1) / image.shape[1]
        else:
            self.seen = None

    def drive(self):
        command = Twist()
        if self.seen is None:
            command.angular.z = -0.5
        else:
            command.angular.z = -0.8 * self.seen[0]
            command.linear.x = 0.2 if self.seen[1] < 0.25 else 0.0
        self.publisher.publish(command)


rclpy.init()
rclpy.spin(Follower())
"""


def test_a_ball_is_found_by_a_camera_and_followed(tmp_path):
    wheels = "".join(WHEEL.format(name=name, y=y) for name, y in (("left", 0.13), ("right", -0.13)))
    world = script(tmp_path, "field.sdf", CART.replace("WHEELS", wheels))
    launch = script(tmp_path, "field.launch.py", LAUNCH.format(world=str(world)))
    with TwinBuilder().launch(launch).node(script(tmp_path, "follower.py", FOLLOWER)).build() as twin:
        twin.advance_to(22.0)
        x, y, _ = twin.entities.state("cart").position
        twin.advance_to(23.0)
        later = twin.entities.state("cart").position
    left = hypot(2 - x, 1 - y)
    assert 0.9 < left < 1.3  # from 2.24 m, to where the ball's 0.24 m are a quarter of the picture
    assert hypot(later[0] - x, later[1] - y) < 0.01


KEYS = f"""
import curses
import os
import signal
import time

import rclpy
from std_msgs.msg import Float64MultiArray


def steer(screen):
    screen.nodelay(True)
    curses.curs_set(0)
    rclpy.init()
    node = rclpy.create_node("keys")
    publisher = node.create_publisher(Float64MultiArray, "{COMMANDS}", 10)
    speed = 0.0
    while True:
        while (key := screen.getch()) != -1:
            speed += {{curses.KEY_UP: 1.0, curses.KEY_DOWN: -1.0}}.get(key, 0.0)
        screen.clear()
        screen.addstr(2, 10, f"speed {{speed}}")
        screen.refresh()
        publisher.publish(Float64MultiArray(data=[speed] * 4))
        time.sleep(0.1)
        if node.get_clock().now().nanoseconds > 1.5e9:
            os.kill(os.getpid(), signal.SIGINT)


try:
    curses.wrapper(steer)
except KeyboardInterrupt:
    print("bye")
"""


def test_keys_of_a_screen_of_curses_steer_a_robot(tmp_path):
    """The wheels turn at 2 rad/s from the first look on, also after the program has ended itself."""
    summary = tmp_path / "summary.json"
    file = script(tmp_path, "keys.py", KEYS)
    words = ["--robots", 1, "--headless", "--duration", 2, "--node", file, "--summary", summary]
    master, slave = pty.openpty()
    os.write(master, b"\x1bOA\x1bOA")
    command = [sys.executable, "-m", "drake_twin.run", *map(str, words)]
    environment = os.environ | {"TERM": "xterm"}
    with subprocess.Popen(command, stdin=slave, stdout=slave, stderr=slave, env=environment) as process:
        os.close(slave)
        out = b""
        try:
            while data := os.read(master, 65536):
                out += data
        except OSError:  # Linux: nobody has the terminal any more
            pass
    os.close(master)
    assert process.returncode == 0
    assert b"speed 2.0" in out
    assert b"bye" in out
    (robot,) = json.loads(summary.read_text())["robots"].values()
    assert robot["positions"] == pytest.approx([2.0 * 2.0] * 4, abs=0.3)


JOYSTICK = """
import sys
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Joy
from std_msgs.msg import Float64MultiArray, String


class Steering(Node):
    '''Takes its commands from parameters: of each, a topic, the button that it needs, and values or axes.'''

    def __init__(self):
        super().__init__(
            "steering", allow_undeclared_parameters=True, automatically_declare_parameters_from_overrides=True
        )
        tree = {}
        for name in sorted(self._parameters):
            place = tree
            *parents, last = name.split(rclpy.parameter.PARAMETER_SEPARATOR_STRING)
            for parent in parents:
                place = place.setdefault(parent, {})
            place[last] = self.get_parameter(name).value
        qos = rclpy.qos.QoSProfile(depth=1, history=rclpy.qos.QoSHistoryPolicy.KEEP_LAST)
        self.commands = [item for item in tree.values() if isinstance(item, dict) and "topic" in item]
        kinds = {"words": String, "speeds": Float64MultiArray}
        self.senders = [self.create_publisher(kinds[item["kind"]], item["topic"], qos) for item in self.commands]
        self.create_subscription(Joy, "joy", self.hear, qos)

    def hear(self, joy):
        for command, sender in zip(self.commands, self.senders):
            if joy.buttons[command["button"]]:
                message = sender.msg_type()
                message.data = command.get("text") or [joy.axes[command["axis"]] * command["scale"]] * 4
                sender.publish(message)


class Stick(Node):
    def __init__(self):
        super().__init__("stick")
        self.publisher = self.create_publisher(Joy, "joy", 1)
        self.create_subscription(String, "said", lambda message: print(message.data), 10)
        self.create_timer(0.1, self.push)

    def push(self):
        late = self.get_clock().now().nanoseconds > 0.95e9
        self.publisher.publish(Joy(axes=[0.0, 0.5], buttons=[int(not late), int(late)]))


rclpy.init()
rclpy.spin(Steering() if sys.argv[1] == "steering" else Stick())
"""
PARAMETERS = f"""steering:
  ros__parameters:
    drive: {{kind: speeds, topic: {COMMANDS}, button: 0, axis: 1, scale: 4.0}}
    stop: {{kind: speeds, topic: {COMMANDS}, button: 1, axis: 0, scale: 1.0}}
    hello: {{kind: words, topic: said, button: 1, text: hello}}
"""


def test_a_joysticks_commands_are_parameters(tmp_path, capsys):
    file = script(tmp_path, "joystick.py", JOYSTICK)
    parameters = script(tmp_path, "joystick.yaml", PARAMETERS)

    builder = TwinBuilder().robot("robot_1", ROVER, xyz=(0, 0, 0.13))
    builder.node(file, "steering", "--ros-args", "--params-file", str(parameters)).node(file, "stick")
    with builder.build() as twin:
        twin.advance_to(2.0)
        assert twin.entities.state("robot_1").position[0] == pytest.approx(0.1 * 2.0 * 0.9, abs=0.02)
    assert set(lines(capsys)) == {"hello"}
