"""What nodes drive moves as it should."""

from math import hypot

import pytest
from node_runs import running, script

SQUARE = """
from math import atan2, cos, pi, sin

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

SIDE = 0.5


class My(Node):
    \"\"\"Drives a square by its odometry, with skid steering.\"\"\"

    def __init__(self):
        super().__init__("square")
        self.publisher = self.create_publisher(Float64MultiArray, "/robot_1/forward_velocity_controller/commands", 10)
        self.create_subscription(Odometry, "/robot_1/ground_truth/odom", self.heard, 10)
        self.pose = None
        self.corners = [(SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE), (0.0, 0.0)]
        self.create_timer(0.02, self.drive)

    def heard(self, message):
        position, orientation = message.pose.pose.position, message.pose.pose.orientation
        self.pose = position.x, position.y, 2 * atan2(orientation.z, orientation.w)

    def drive(self):
        if self.pose is None:
            return
        x, y, heading = self.pose
        speed = turn = 0.0
        if self.corners:
            dx, dy = self.corners[0][0] - x, self.corners[0][1] - y
            error = atan2(dy, dx) - heading
            error = atan2(sin(error), cos(error))
            if dx * cos(heading) + dy * sin(heading) < 0.01 and dx * dx + dy * dy < 0.01:
                self.get_logger().info(f"corner {x:.3f} {y:.3f}")
                self.corners.pop(0)
            elif abs(error) > 0.05:
                turn = max(-3.0, min(3.0, 6.0 * error))
            else:
                speed, turn = 3.0, 4.0 * error
        self.publisher.publish(Float64MultiArray(data=[speed - turn, speed + turn, speed - turn, speed + turn]))
"""


def test_a_square_is_a_square(tmp_path, capfd):
    with running(script(tmp_path, "square.py", SQUARE)) as twin:
        twin.advance_to(25.0)
        x, y, _ = twin.entities.state("robot_1").position
        assert twin.findings == ()
    said = [line.split("corner ")[1].split() for line in capfd.readouterr().err.splitlines() if "corner" in line]
    corners = [(float(a), float(b)) for a, b in said]
    assert len(corners) == 4
    for found, wanted in zip(corners, ((0.5, 0.0), (0.5, 0.5), (0.0, 0.5), (0.0, 0.0)), strict=True):
        assert found == pytest.approx(wanted, abs=0.06)
    assert hypot(x, y) < 0.06
