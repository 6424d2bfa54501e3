"""``pointcloud_to_laserscan/pointcloud_to_laserscan_node``, and ``laserscan_to_pointcloud_node``, which goes back.

Source: ros-perception/pointcloud_to_laserscan, src/pointcloud_to_laserscan_node.cpp and
src/laserscan_to_pointcloud_node.cpp.
"""

import os
import sys
from math import inf, pi
from typing import Any

import numpy as np
import rclpy
from laser_geometry import LaserProjection
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from sensor_msgs.msg import LaserScan, PointCloud2
from sensor_msgs_py.point_cloud2 import read_points
from tf2_ros import Buffer, TransformException, TransformListener
from tf2_sensor_msgs import do_transform_cloud

from drake_twin.nodes.scans import ranges_of_points

_LOOK = 0.1  # s
_LARGEST = sys.float_info.max
_LEAST_HEIGHT = sys.float_info.min  # as upstream has it: what is not above the frame's origin does not count
_LARGEST_FLOAT = float(np.finfo(np.float32).max)


class Converter(Node):
    """Converts one topic to another one while that has subscribers.

    Args:
        name: The name of the node.
        source: The topic that it hears, and its type.
        target: The topic that it publishes, and its type.
    """

    def __init__(self, name: str, source: tuple[str, type], target: tuple[str, type]):
        super().__init__(name)
        self._frame = self.declare_parameter("target_frame", "").value
        self._size = max(1, self.declare_parameter("queue_size", os.cpu_count() or 1).value)
        self.declare_parameter("transform_tolerance", 0.01)
        self._source = source
        self._waiting: list[Any] = []
        self._buffer: Any = None
        if self._frame:
            self._buffer = Buffer()
            self._listener = TransformListener(self._buffer, self)
        self.publisher = self.create_publisher(target[1], target[0], _sensor_data(5))
        self._subscription: Any = None
        self.create_timer(_LOOK, self._look)
        self._look()

    def _look(self) -> None:
        is_heard = self.publisher.get_subscription_count() > 0
        if is_heard and self._subscription is None:
            topic, kind = self._source
            self._subscription = self.create_subscription(kind, topic, self._hear, _sensor_data(self._size))
        elif not is_heard and self._subscription is not None:
            self.destroy_subscription(self._subscription)
            self._subscription = None

    def _hear(self, message: Any) -> None:
        """Convert a message, or keep it until its frame can be placed."""
        frame = message.header.frame_id
        if not self._frame or frame == self._frame:
            self.convert(message, None)
            return
        self._waiting = [*self._waiting, message][-self._size :]
        future = self._buffer.wait_for_transform_async(self._frame, frame, Time.from_msg(message.header.stamp))
        future.add_done_callback(lambda _: self._place(message))

    def _place(self, message: Any) -> None:
        if message not in self._waiting:
            return
        self._waiting.remove(message)
        stamp = Time.from_msg(message.header.stamp)
        try:
            transform = self._buffer.lookup_transform(self._frame, message.header.frame_id, stamp)
        except TransformException as error:
            self.get_logger().error(f"Transform failure: {error}")
            return
        self.convert(message, transform)

    def convert(self, message: Any, transform: Any) -> None:
        """Publish what a message becomes, in the target frame where a transform to it is given."""
        raise NotImplementedError


class PointCloudToLaserScan(Converter):
    """Publishes ``scan``."""

    def __init__(self) -> None:
        super().__init__("pointcloud_to_laserscan", ("cloud_in", PointCloud2), ("scan", LaserScan))

        def number(name: str, default: float) -> float:
            return float(self.declare_parameter(name, default).value)

        self._heights = number("min_height", _LEAST_HEIGHT), number("max_height", _LARGEST)
        self._angles = number("angle_min", -pi), number("angle_max", pi), number("angle_increment", pi / 180.0)
        self._scan_time = number("scan_time", 1.0 / 30.0)
        self._limits = number("range_min", 0.0), number("range_max", _LARGEST)
        more = number("inf_epsilon", 1.0)
        self._empty = inf if self.declare_parameter("use_inf", True).value else self._limits[1] + more

    def convert(self, message: Any, transform: Any) -> None:
        """Publish the scan of a cloud."""
        cloud = message if transform is None else do_transform_cloud(message, transform)
        read = read_points(cloud, ("x", "y", "z"))
        points = np.stack([read[name].ravel() for name in "xyz"], axis=-1)
        ranges = ranges_of_points(points, self._angles, self._heights, self._limits, self._empty)
        scan = LaserScan(header=message.header, scan_time=self._scan_time)
        scan.angle_min, scan.angle_max, scan.angle_increment = self._angles
        scan.range_min, scan.range_max = (inf if limit > _LARGEST_FLOAT else limit for limit in self._limits)
        scan.ranges = ranges.astype(np.float32).tolist()
        if self._frame:
            scan.header.frame_id = self._frame
        self.publisher.publish(scan)


class LaserScanToPointCloud(Converter):
    """Publishes ``cloud``."""

    def __init__(self) -> None:
        super().__init__("laserscan_to_pointcloud", ("scan_in", LaserScan), ("cloud", PointCloud2))
        self._projection = LaserProjection()

    def convert(self, message: Any, transform: Any) -> None:
        """Publish the cloud of a scan."""
        cloud = self._projection.projectLaser(message)
        self.publisher.publish(cloud if transform is None else do_transform_cloud(cloud, transform))


def _sensor_data(depth: int) -> QoSProfile:
    return QoSProfile(depth=depth, reliability=ReliabilityPolicy.BEST_EFFORT)


def scan() -> None:
    """Run ``pointcloud_to_laserscan_node``."""
    rclpy.init()
    rclpy.spin(PointCloudToLaserScan())


def cloud() -> None:
    """Run ``laserscan_to_pointcloud_node``."""
    rclpy.init()
    rclpy.spin(LaserScanToPointCloud())
