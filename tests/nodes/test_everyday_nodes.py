"""Nodes in the shape of those that people publish: relative moves, a command timeout, a commander of robots."""

from math import atan2, degrees

import pytest
from conftest import ROVER, rovers
from node_runs import HEAD, script

from drake_twin.builder.twin_builder import TwinBuilder
from drake_twin.twin.replay import replay

VELOCITY = "/robot_1/drive/cmd_vel_unstamped"


def drivable():
    """A rover with a drive that takes velocities and tells its odometry."""
    builder = TwinBuilder(time_step=0.002).robot("robot_1", ROVER, xyz=(0, 0, 0.13), active_controllers=())
    wheels = [f"robot_1_{end}_{side}_wheel_joint" for side in ("left", "right") for end in ("front", "rear")]
    parameters = {
        "left_wheel_names": wheels[:2],
        "right_wheel_names": wheels[2:],
        "wheel_separation": 0.41,
        "wheel_radius": 0.1,
        "wheel_separation_multiplier": 1.69,
        "use_stamped_vel": False,
        "cmd_vel_timeout": 0.0,
    }
    return builder.controller("robot_1", "drive", "diff_drive_controller/DiffDriveController", parameters)


def heading(state):
    """The direction that a robot faces (degrees)."""
    w, _, _, z = state.orientation
    return degrees(2 * atan2(z, w))


def twice(build, run):
    """Run a twin twice, and replay the second run; return what ``run`` has returned."""
    found, hashes = [], []
    for _ in range(2):
        with build().build() as twin:
            twin.recorder.begin()
            found.append(run(twin))
            assert [item.what for item in twin.findings if "node" in item.what] == []
            hashes.append(twin.state_sha256())
            recording = twin.recorder.recording()
    with replay(recording) as again:
        hashes.append(again.state_sha256())
    assert len(set(hashes)) == 1
    assert found[0] == found[1]
    return found[0]


MOVES = """
from math import atan2, cos, hypot, pi, sin
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile


class My(Node):
    \"\"\"Turns towards a place relative to where it is, drives there and turns; then to the next one.\"\"\"

    def __init__(self):
        super().__init__("moves")
        self.publisher = self.create_publisher(Twist, "cmd_vel", QoSProfile(depth=10))
        self.create_subscription(Odometry, "odom", self.hear, QoSProfile(depth=10))
        self.create_timer(0.02, self.drive)
        self.pose = self.goal = None
        self.moves = iter([(0.4, 0.0, pi / 2)] * 4)

    def hear(self, message):
        q = message.pose.pose.orientation
        self.pose = message.pose.pose.position.x, message.pose.pose.position.y, 2 * atan2(q.z, q.w)

    def drive(self):
        if self.pose is None:
            return
        x, y, theta = self.pose
        if self.goal is None:
            move = next(self.moves, None)
            if move is None:
                raise SystemExit
            forward, left, turn = move
            x, y = x + cos(theta) * forward - sin(theta) * left, y + sin(theta) * forward + cos(theta) * left
            self.goal = x, y, theta + turn
            x, y, _ = self.pose
            self.steps = [self.face, self.approach, self.turn]
        twist = Twist()
        if not self.steps[0](twist, x, y, theta):
            self.steps.pop(0)
        if not self.steps:
            print(f"{x:.2f} {y:.2f}")
            self.goal = None
        self.publisher.publish(twist)

    def rotate(self, twist, angle):
        angle = atan2(sin(angle), cos(angle))
        twist.angular.z = max(-1.0, min(1.0, 4 * angle))
        return abs(angle) > 0.01

    def face(self, twist, x, y, theta):
        return self.rotate(twist, atan2(self.goal[1] - y, self.goal[0] - x) - theta)

    def approach(self, twist, x, y, theta):
        distance = hypot(self.goal[0] - x, self.goal[1] - y)
        twist.linear.x = min(0.3, 3 * distance)
        return distance > 0.01

    def turn(self, twist, x, y, theta):
        return self.rotate(twist, self.goal[2] - theta)
"""


@pytest.mark.slow  # tests/nodes/test_node_motion.py has a square of absolute moves, too
def test_four_relative_moves_are_a_square(tmp_path, capsys):
    file = script(tmp_path, "moves.py", MOVES)
    names = {"cmd_vel": VELOCITY, "odom": "/robot_1/drive/odom"}

    def run(twin):
        twin.advance_to(20.0)
        state = twin.entities.state("robot_1")
        return *state.position[:2], heading(state), capsys.readouterr().out

    x, y, angle, said = twice(lambda: drivable().node(file, remappings=names), run)
    corners = [[float(number) for number in line.split()] for line in said.splitlines()]
    assert len(corners) == 4
    for corner, expected in zip(corners, [(0.4, 0), (0.4, 0.4), (0, 0.4), (0, 0)], strict=True):
        assert corner == pytest.approx(expected, abs=0.03)
    assert (x, y) == pytest.approx((0, 0), abs=0.05)
    assert angle == pytest.approx(0, abs=6)


BRAKE = """
from geometry_msgs.msg import Twist


class My(Node):
    \"\"\"Stops a robot whose last command is 0.2 s old.\"\"\"

    def __init__(self):
        super().__init__("brake")
        self.last, self.stands = self.get_clock().now(), True
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Twist, "cmd_vel", self.hear, 10)
        self.create_timer(0.2, self.look)

    def look(self):
        if (self.get_clock().now() - self.last).nanoseconds >= 2e8 and not self.stands:
            self.stands = True
            self.publisher.publish(Twist())

    def hear(self, message):
        if message.linear.x != 0:
            self.last, self.stands = self.get_clock().now(), False
"""

PUSH = """
from geometry_msgs.msg import Twist


class My(Node):
    def __init__(self):
        super().__init__("push")
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_timer(0.5, self.push)

    def push(self):
        if self.get_clock().now().nanoseconds < 600000000:
            message = Twist()
            message.linear.x = 0.5
            self.publisher.publish(message)
"""


def test_a_command_timeout(tmp_path):
    """A command at 0.5 s is heard a step later: it is 0.1 s old at 0.6 s, and 0.3 s at 0.8 s."""
    brake, push = script(tmp_path, "brake.py", BRAKE), script(tmp_path, "push.py", PUSH)
    names = {"cmd_vel": VELOCITY}

    def run(twin):
        twin.advance_to(0.798)
        moves = twin.graph.command(VELOCITY).linear_x
        twin.advance_to(1.5)
        return moves, twin.graph.command(VELOCITY).linear_x, twin.entities.state("robot_1").position[0]

    moving, standing, x = twice(lambda: drivable().node(brake, remappings=names).node(push, remappings=names), run)
    assert (moving, standing) == (0.5, 0.0)
    assert x == pytest.approx(0.5 * 0.3, abs=0.01)


COMMANDER = """
import threading
import numpy as np
from rclpy.executors import MultiThreadedExecutor


class Commander(Node):
    def __init__(self, robot, speeds):
        super().__init__("commander_" + robot)
        self.speeds = np.zeros(4)
        self.wanted = np.array(speeds, float)
        self.publisher = self.create_publisher(Float64MultiArray, f"{robot}/forward_velocity_controller/commands", 100)
        self.create_timer(0.002, self.tick)

    def tick(self):
        self.speeds[:] = self.wanted
        self.publisher.publish(Float64MultiArray(data=self.speeds))


def main():
    rclpy.init(args=None)
    commanders = [Commander("robot_1", [2] * 4), Commander("robot_2", [-2] * 4), Commander("robot_3", [-2, 2, -2, 2])]
    executor = MultiThreadedExecutor()
    for commander in commanders:
        executor.add_node(commander)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    rate = commanders[0].create_rate(2)
    try:
        while rclpy.ok():
            rate.sleep()
            print([round(speed, 1) for speed in commanders[1].speeds.tolist()])
            commanders[1].wanted[:] = 0
    except KeyboardInterrupt:
        pass
    finally:
        rclpy.shutdown()
        thread.join()
        print("joined")


main()
"""


@pytest.mark.filterwarnings("error")  # of threads that end with an error
def test_a_commander_of_three_robots(tmp_path, capsys):
    file = script(tmp_path, "commander.py", HEAD + COMMANDER)

    def run(twin):
        twin.advance_to(1.2)
        states = [twin.entities.state(f"robot_{index}") for index in (1, 2, 3)]
        return *(state.position[0] for state in states), heading(states[2])

    first, second, _, angle = twice(lambda: rovers(3, time_step=0.002).node(file), run)
    assert first == pytest.approx(2 * 0.1 * 1.2, abs=0.01)  # rad/s, m, s
    assert second == pytest.approx(-2 * 0.1 * 0.5, abs=0.01)
    assert angle > 20
    assert capsys.readouterr().out.splitlines() == ["[-2.0, -2.0, -2.0, -2.0]", "[0.0, 0.0, 0.0, 0.0]", "joined"] * 2
