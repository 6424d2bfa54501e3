"""``depthimage_to_laserscan/depthimage_to_laserscan_node``: a laser scan of the middle rows of depth images.

Source: ros-perception/depthimage_to_laserscan (ros2), src/DepthImageToLaserScanROS.cpp. A distorted camera needs
OpenCV.
"""

from typing import Any

import numpy as np
import rclpy
from image_geometry import PinholeCameraModel
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, Image, LaserScan

from drake_twin.nodes.scans import ranges_of_depths

_UNITS = {"16UC1": (np.uint16, 1e-3), "32FC1": (np.float32, 1.0)}


class DepthImageToLaserScan(Node):
    """Publishes ``scan``."""

    def __init__(self) -> None:
        super().__init__("depthimage_to_laserscan")
        self._camera: PinholeCameraModel | None = None
        self._rays = 0.0, 0.0
        self.create_subscription(CameraInfo, "depth_camera_info", self._hear_camera, 10)
        self.create_subscription(Image, "depth", self._hear, 10)
        self._publisher = self.create_publisher(LaserScan, "scan", 10)
        self._scan_time = self.declare_parameter("scan_time", 0.033).value
        self._limits = self.declare_parameter("range_min", 0.45).value, self.declare_parameter("range_max", 10.0).value
        self._height = self.declare_parameter("scan_height", 1).value
        self._frame = self.declare_parameter("output_frame", "camera_depth_frame").value

    def _hear_camera(self, message: CameraInfo) -> None:
        camera = PinholeCameraModel()
        camera.fromCameraInfo(message)
        edges = [(column, camera.cy()) for column in (0, message.width - 1)]
        if any(message.d):
            edges = [camera.rectifyPoint(edge) for edge in edges]
        self._camera = camera
        left, right = ((edge[0] - camera.cx()) / camera.fx() for edge in edges)
        self._rays = left, right

    def _hear(self, image: Image) -> None:
        if self._camera is None:
            self.get_logger().info("No camera info, skipping point cloud squash")
            return
        try:
            self._publisher.publish(self._scan(image, self._camera))
        except ValueError as error:
            self.get_logger().error(f"Could not convert depth image to laserscan: {error}")

    def _scan(self, image: Image, camera: PinholeCameraModel) -> LaserScan:
        if image.encoding not in _UNITS:
            raise ValueError(f"Depth image has unsupported encoding: {image.encoding}")
        kind, unit = _UNITS[image.encoding]
        rows: Any = np.frombuffer(image.data, dtype=np.uint8).reshape(image.height, image.step)
        order = np.dtype(kind).newbyteorder(">" if image.is_bigendian else "<")
        depths = rows[:, : image.width * order.itemsize].copy().view(order)
        view = camera.fx(), camera.cx(), camera.cy()
        first, last, ranges = ranges_of_depths(depths, unit, view, self._rays, self._height, self._limits)
        scan = LaserScan(header=image.header, angle_min=first, angle_max=last, scan_time=self._scan_time)
        scan.angle_increment = (last - first) / (image.width - 1)
        scan.range_min, scan.range_max = self._limits
        scan.ranges = ranges.astype(np.float32).tolist()
        if self._frame:
            scan.header.frame_id = self._frame
        return scan


def main() -> None:
    """Run the node."""
    rclpy.init()
    rclpy.spin(DepthImageToLaserScan())
