"""``turtlesim_node`` and ``mimic``, against what turtle.cpp and turtle_frame.cpp compute."""

from math import cos, pi, sin

import pytest
from node_runs import HEAD, lines, running, script

SIM = ("turtlesim_node", {"package": "turtlesim"})
WATCH = (
    HEAD
    + """
from functools import partial
from geometry_msgs.msg import Twist
from rclpy.action import ActionClient
from std_srvs.srv import Empty
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Color, Pose
from turtlesim.srv import Kill, SetPen, Spawn, TeleportAbsolute, TeleportRelative

class My(Node):
    def __init__(self):
        super().__init__("my")
        self.move = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "turtle1/pose", self.hear, 10)
        self.last = None
        self.begin()

    def hear(self, pose):
        self.last = pose

    def tell(self, turn=0.0, forward=0.0, left=0.0):
        twist = Twist()
        twist.linear.x, twist.linear.y, twist.angular.z = forward, left, turn
        self.move.publish(twist)

    def call(self, kind, service, **request):
        client = self.create_client(kind, service)
        client.wait_for_service()
        future = client.call_async(kind.Request(**request))
        rclpy.spin_until_future_complete(self, future)
        return future.result()

    def print_pose(self):
        pose = self.last
        print(*(f"{item:.6f}" for item in (pose.x, pose.y, pose.theta, pose.linear_velocity, pose.angular_velocity)))

    def print_after(self, seconds):
        future = rclpy.task.Future()
        timer = self.create_timer(seconds, lambda: future.set_result(None))
        rclpy.spin_until_future_complete(self, future)
        self.destroy_timer(timer)
        self.print_pose()

    def begin(self):
%s
"""
)
TAIL = """
def main():
    rclpy.init()
    rclpy.spin(My())

main()
"""


@pytest.fixture
def watch(tmp_path, capsys):
    """Runs what a node does beside turtlesim; returns the lines that it prints."""

    def run(*statements, seconds=3.0, sim=SIM, more=()):
        text = WATCH % "\n".join(f"        {line}" for line in statements) + TAIL
        with running(sim, *more, script(tmp_path, "my.py", text)) as twin:
            twin.advance_to(seconds)
            assert twin.more_findings == []
        return [line for line in lines(capsys) if not line.startswith("[")]

    return run


def numbers(line):
    return [float(item) for item in line.split()]


def test_the_first_turtle_stands_in_the_middle_and_looks_to_the_right(watch):
    """(500 - 1) / 45 / 2, turtle_frame.cpp:138."""
    assert numbers(watch("self.print_after(0.5)")[0]) == pytest.approx([5.544445, 5.544445, 0, 0, 0], abs=1e-6)


def test_a_command_lasts_for_a_second_in_steps_of_16_ms(watch):
    """turtle.cpp: the heading first, then the position, each step; after 1 s the turtle stops."""
    x, y, angle = 5.544445, 5.544445, 0.0
    (line,) = watch("self.tell(forward=2.0, turn=1.0)", "self.print_after(2.5)")
    found = numbers(line)
    steps = round(found[2] / 0.016)
    for _ in range(steps):
        angle += 0.016
        x, y = x + cos(angle) * 2 * 0.016, y + sin(angle) * 2 * 0.016
    assert 61 <= steps <= 64
    assert found == pytest.approx([x, y, angle, 0, 0], abs=1e-5)


def test_sideways_moves_are_for_the_holonomic(watch):
    says = "self.tell(left=1.0)", "self.print_after(2.0)"
    assert numbers(watch(*says)[0])[1] == pytest.approx(5.544445, abs=1e-6)
    holonomic = ("turtlesim_node", {"package": "turtlesim", "parameters": {"holonomic": True}})
    assert numbers(watch(*says, sim=holonomic)[0])[1] == pytest.approx(5.544445 + 1.0, abs=0.03)


def test_walls_stop_a_turtle(watch, caplog):
    says = "self.call(TeleportAbsolute, 'turtle1/teleport_absolute', x=11.0, y=5.0)", "self.tell(forward=2.0)"
    assert numbers(watch(*says, "self.print_after(0.8)")[0])[:2] == pytest.approx([499 / 45, 5.0], abs=1e-5)


def test_teleports(watch):
    """Absolute ones set the pose; relative ones turn first, then go ahead."""
    found = watch(
        "self.call(TeleportAbsolute, 'turtle1/teleport_absolute', x=2.0, y=3.0, theta=0.5)",
        "self.print_after(0.1)",
        "self.call(TeleportRelative, 'turtle1/teleport_relative', linear=1.0, angular=0.25)",
        "self.print_after(0.1)",
    )
    assert numbers(found[0])[:3] == pytest.approx([2, 3, 0.5], abs=1e-6)
    assert numbers(found[1])[:3] == pytest.approx([2 + cos(0.75), 3 + sin(0.75), 0.75], abs=1e-5)


def test_turtles_come_and_go(watch):
    """A name that is there already gets an empty one back; one without a name gets the next free number."""
    found = watch(
        "print(repr(self.call(Spawn, 'spawn', x=1.0, y=2.0, theta=0.5, name='anna').name))",
        "print(repr(self.call(Spawn, 'spawn', name='anna').name))",
        "print(repr(self.call(Spawn, 'spawn', name='turtle2').name))",
        "print(repr(self.call(Spawn, 'spawn').name))",
        "self.create_subscription(Pose, 'anna/pose', self.hear, 10)",
        "self.call(Kill, 'kill', name='turtle1')",
        "self.print_after(0.2)",
        "self.call(Kill, 'kill', name='nobody')",
        "print(*sorted(name for name, _ in self.get_topic_names_and_types() if name.endswith('/pose')))",
        "self.call(Empty, 'reset')",
        "print(*sorted(name for name, _ in self.get_service_names_and_types() if name.endswith('/set_pen')))",
    )
    assert found[:4] == ["'anna'", "''", "'turtle2'", "'turtle3'"]
    assert numbers(found[4])[:3] == pytest.approx([1, 2, 0.5], abs=1e-6)
    assert found[5:] == [
        "/anna/pose /turtle1/pose /turtle2/pose /turtle3/pose",
        "/turtle1/set_pen",
    ]


ROTATE = (
    "client = ActionClient(self, RotateAbsolute, 'turtle1/rotate_absolute')",
    "client.wait_for_server()",
    "sent = client.send_goal_async(RotateAbsolute.Goal(theta=1.0), feedback_callback=lambda _: None)",
    "rclpy.spin_until_future_complete(self, sent)",
    "ended = sent.result().get_result_async()",
)


def test_a_rotation_turns_by_1_rad_a_second_until_it_is_close(watch):
    """turtle.cpp: it ends once less than 0.02 rad remain; delta is the start's heading less the present one."""
    found = watch(
        *ROTATE,
        "rclpy.spin_until_future_complete(self, ended)",
        "print(ended.result().status, ended.result().result.delta)",
        "self.print_after(0.5)",
    )
    assert numbers(found[0]) == pytest.approx([4, -1.0], abs=0.02)
    assert numbers(found[1])[2:] == pytest.approx([1.0, 0, 0], abs=0.02)


def test_a_command_aborts_a_rotation(watch):
    found = watch(
        *ROTATE,
        "self.tell(turn=-1.0)",
        "rclpy.spin_until_future_complete(self, ended)",
        "print(ended.result().status)",
    )
    assert found == ["6"]


def test_a_cancelled_rotation_stops(watch):
    found = watch(
        *ROTATE,
        "self.print_after(0.3)",
        "sent.result().cancel_goal_async()",
        "rclpy.spin_until_future_complete(self, ended)",
        "print(ended.result().status)",
        "self.print_after(0.5)",
    )
    assert found[1] == "5"
    assert numbers(found[2])[2:] == pytest.approx([numbers(found[0])[2], 0, 0], abs=0.1)


def test_the_colour_under_a_turtle_is_that_of_the_pens(watch):
    """turtle.cpp: the default pen is b3 b8 ff; what is not drawn on is transparent white."""
    found = watch(
        "self.create_subscription(Color, 'turtle1/color_sensor', lambda m: setattr(self, 'color', m), 10)",
        "print_color = lambda: (self.print_after(0.2), print(self.color.r, self.color.g, self.color.b))",
        "print_color()",
        "self.tell(forward=1.0)",
        "self.print_after(0.5)",
        "self.tell()",
        "print_color()",
        "self.call(SetPen, 'turtle1/set_pen', r=10, g=20, b=30, width=5)",
        "self.call(TeleportRelative, 'turtle1/teleport_relative', linear=-2.0)",
        "print_color()",
        "self.call(Empty, 'clear')",
        "print_color()",
        "self.call(SetPen, 'turtle1/set_pen', off=1)",
        "self.call(TeleportRelative, 'turtle1/teleport_relative', linear=1.0)",
        "print_color()",
        seconds=5.0,
    )
    colors = [line for line in found if "." not in line]
    assert colors == ["255 255 255", "179 184 255", "10 20 30", "255 255 255", "255 255 255"]


def test_a_mimic_moves_as_the_other_one(watch):
    """mimic.cpp: the speed and the turn of input/pose are the command of output/cmd_vel."""
    remappings = {"input/pose": "turtle1/pose", "output/cmd_vel": "anna/cmd_vel"}
    found = watch(
        "self.call(Spawn, 'spawn', x=1.0, y=2.0, name='anna')",
        "self.tell(forward=1.0, turn=0.5)",
        "self.print_after(2.0)",
        "self.create_subscription(Pose, 'anna/pose', self.hear, 10)",
        "self.call(Kill, 'kill', name='turtle1')",
        "self.print_after(0.2)",
        more=[("mimic", {"package": "turtlesim", "remappings": remappings})],
    )
    first, second = map(numbers, found)
    assert second[2] == pytest.approx(first[2], abs=0.02)
    assert second[0] - 1.0 == pytest.approx(first[0] - 5.544445, abs=0.03)
    assert second[1] - 2.0 == pytest.approx(first[1] - 5.544445, abs=0.03)


def test_angles_are_between_minus_pi_and_pi(watch):
    found = watch("self.call(TeleportAbsolute, 'turtle1/teleport_absolute', theta=4.0)", "self.print_after(0.1)")
    assert numbers(found[0])[2] == pytest.approx(4.0 - 2 * pi, abs=1e-6)
