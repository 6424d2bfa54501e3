"""``twist_stamper/twist_stamper`` and ``twist_unstamper``: twists with a header from twists without, and back.

Source: joshnewans/twist_stamper. It is Python there as well; here it runs where the workspace does not have it.
"""

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.node import Node


class Stamper(Node):
    """Gives each twist the present time and the parameter ``frame_id``."""

    def __init__(self) -> None:
        super().__init__("twist_stamper")
        self._frame = self.declare_parameter("frame_id", "").value
        self._publisher = self.create_publisher(TwistStamped, "cmd_vel_out", 10)
        self.create_subscription(Twist, "cmd_vel_in", self._stamp, 10)

    def _stamp(self, twist: Twist) -> None:
        message = TwistStamped(twist=twist)
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id = self._frame
        self._publisher.publish(message)


class Unstamper(Node):
    """Leaves the header out."""

    def __init__(self) -> None:
        super().__init__("twist_unstamper")
        self._publisher = self.create_publisher(Twist, "cmd_vel_out", 10)
        self.create_subscription(TwistStamped, "cmd_vel_in", lambda message: self._publisher.publish(message.twist), 10)


def stamp() -> None:
    """Run ``twist_stamper``."""
    rclpy.init()
    rclpy.spin(Stamper())


def unstamp() -> None:
    """Run ``twist_unstamper``."""
    rclpy.init()
    rclpy.spin(Unstamper())
