"""``teleop_twist_keyboard``: twists from the keys of the terminal.

Source: ros2/teleop_twist_keyboard, teleop_twist_keyboard.py, with the parameters of Jazzy: ``stamped``, ``frame_id``,
``speed`` (m/s) and ``turn`` (rad/s). It is Python there as well; here it runs where the workspace does not have it.
"""

import sys
import termios
import tty

import rclpy
from geometry_msgs.msg import Twist, TwistStamped

_HELP = """Moving around:    u i o    with shift held down:    U I O
                  j k l    (strafing)               J K L
                  m , .                             M < >
t/b up/down, anything else stops; q/z both speeds by 10 %, w/x the linear one, e/c the angular one; Ctrl-C ends."""
# Key → the parts of the speed in x, y, z, and of the turn.
_MOVES = {
    "i": (1, 0, 0, 0),
    "o": (1, 0, 0, -1),
    "j": (0, 0, 0, 1),
    "l": (0, 0, 0, -1),
    "u": (1, 0, 0, 1),
    ",": (-1, 0, 0, 0),
    ".": (-1, 0, 0, 1),
    "m": (-1, 0, 0, -1),
    "O": (1, -1, 0, 0),
    "I": (1, 0, 0, 0),
    "J": (0, 1, 0, 0),
    "L": (0, -1, 0, 0),
    "U": (1, 1, 0, 0),
    "<": (-1, 0, 0, 0),
    ">": (-1, -1, 0, 0),
    "M": (-1, 1, 0, 0),
    "t": (0, 0, 1, 0),
    "b": (0, 0, -1, 0),
}
# Key → the factors of the speed and of the turn.
_FACTORS = {"q": (1.1, 1.1), "z": (0.9, 0.9), "w": (1.1, 1), "x": (0.9, 1), "e": (1, 1.1), "c": (1, 0.9)}


def main() -> None:
    """Run the node until Ctrl-C, or the end of the input."""
    if not sys.stdin.isatty():
        raise SystemExit("standard input is not a terminal: there are no keys to read")
    rclpy.init()
    node = rclpy.create_node("teleop_twist_keyboard")
    is_stamped = node.declare_parameter("stamped", False).value
    frame = node.declare_parameter("frame_id", "").value
    speed, turn = (node.declare_parameter(name, value).value for name, value in (("speed", 0.5), ("turn", 1.0)))
    publisher = node.create_publisher(TwistStamped if is_stamped else Twist, "cmd_vel", 10)

    def publish(x: float = 0, y: float = 0, z: float = 0, way: float = 0) -> None:
        message = TwistStamped() if is_stamped else Twist()
        twist = message
        if is_stamped:
            message.header.stamp, message.header.frame_id = node.get_clock().now().to_msg(), frame
            twist = message.twist
        twist.linear.x, twist.linear.y, twist.linear.z = x * speed, y * speed, z * speed
        twist.angular.z = way * turn
        publisher.publish(message)

    print(f"{_HELP}\ncurrently:\tspeed {speed:g}\tturn {turn:g}", flush=True)
    before = termios.tcgetattr(sys.stdin)
    move: tuple[int, ...] = (0, 0, 0, 0)
    try:
        tty.setcbreak(sys.stdin.fileno())  # not raw, so that Ctrl-C ends the twin as well
        while (key := sys.stdin.read(1)) not in ("", "\x03"):
            if key in _FACTORS:
                speed, turn = speed * _FACTORS[key][0], turn * _FACTORS[key][1]
                print(f"currently:\tspeed {speed:g}\tturn {turn:g}", flush=True)
            else:
                move = _MOVES.get(key, (0, 0, 0, 0))
            publish(*move)
    finally:
        publish()
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)
