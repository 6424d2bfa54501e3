"""``turtle_teleop_key``: the arrow keys of the terminal drive a turtle of turtlesim, and letters turn it.

Source: ros/ros_tutorials, turtlesim/tutorials/teleop_turtle_key.cpp, with its parameters ``scale_linear`` and
``scale_angular``.
"""

import sys
import termios
import threading
import tty
from math import pi
from typing import Any

import rclpy
from geometry_msgs.msg import Twist
from rclpy.action import ActionClient
from turtlesim.action import RotateAbsolute

_HELP = """Reading from keyboard
---------------------------
Use arrow keys to move the turtle.
Use g|b|v|c|d|e|r|t keys to rotate to absolute orientations. 'f' to cancel a rotation.
'q' to quit."""
# The last byte of an arrow key → the speed ahead and the turn.
_MOVES = {"A": (1.0, 0.0), "B": (-1.0, 0.0), "C": (0.0, -1.0), "D": (0.0, 1.0)}
_HEADINGS = {key: pi * part / 4 for key, part in zip("gtredcvb", (0, 1, 2, 3, 4, -3, -2, -1), strict=True)}


def main() -> None:
    """Run the node until q, Ctrl-C or the end of the input."""
    if not sys.stdin.isatty():
        raise SystemExit("standard input is not a terminal: there are no keys to read")
    rclpy.init()
    node = rclpy.create_node("teleop_turtle")
    ahead, turn = (node.declare_parameter(f"scale_{name}", 2.0).value for name in ("linear", "angular"))
    publisher = node.create_publisher(Twist, "turtle1/cmd_vel", 1)
    client = ActionClient(node, RotateAbsolute, "turtle1/rotate_absolute")
    goals: list[Any] = []
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    print(_HELP, flush=True)
    before = termios.tcgetattr(sys.stdin)
    try:
        tty.setcbreak(sys.stdin.fileno())  # not raw, so that Ctrl-C ends the twin as well
        while (key := sys.stdin.read(1)) not in ("", "\x03", "q"):
            if key in _MOVES:
                twist = Twist()
                twist.linear.x, twist.angular.z = ahead * _MOVES[key][0], turn * _MOVES[key][1]
                publisher.publish(twist)
            elif key in _HEADINGS:
                sent = client.send_goal_async(RotateAbsolute.Goal(theta=_HEADINGS[key]))
                sent.add_done_callback(lambda future: goals.append(future.result()))
            elif key == "f" and goals:
                goals[-1].cancel_goal_async()
    finally:
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)
