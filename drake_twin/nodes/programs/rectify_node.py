"""``image_proc/rectify_node``: images without their lens's distortion.

Source: ros-perception/image_pipeline, image_proc/src/rectify.cpp. Images are raw, and interpolated linearly. A
distorted camera needs OpenCV; the images of another one pass as they are.
"""

from typing import Any

import numpy as np
import rclpy
from cv_bridge import CvBridge
from image_geometry import PinholeCameraModel
from message_filters import Subscriber, TimeSynchronizer
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, Image

_LOOK = 0.1  # s


class Rectify(Node):
    """Publishes ``image_rect`` while it has subscribers."""

    def __init__(self) -> None:
        super().__init__("RectifyNode")
        self.declare_parameter("image_transport", "raw")
        self._size = self.declare_parameter("queue_size", 5).value
        self.declare_parameter("interpolation", 1)
        self._publisher = self.create_publisher(Image, "image_rect", 10)
        self._bridge = CvBridge()
        self._timer = self.create_timer(_LOOK, self._look)
        self._look()

    def _look(self) -> None:
        if self._publisher.get_subscription_count():
            self._timer.cancel()
            image = self.resolve_topic_name("image")
            info = f"{image.rpartition('/')[0]}/camera_info"
            both = [Subscriber(self, Image, image), Subscriber(self, CameraInfo, info)]
            self._synchronizer: Any = TimeSynchronizer(both, self._size)
            self._synchronizer.registerCallback(self._rectify)

    def _rectify(self, image: Any, info: Any) -> None:
        if info.k[0] == 0.0:
            self.get_logger().error(f"Rectified topic {self._publisher.topic_name!r} requested but camera uncalibrated")
        elif not any(info.d):
            self._publisher.publish(image)
        else:
            camera = PinholeCameraModel()
            camera.fromCameraInfo(info)
            raw = self._bridge.imgmsg_to_cv2(image)
            rectified = np.empty_like(raw)
            camera.rectifyImage(raw, rectified)
            self._publisher.publish(self._bridge.cv2_to_imgmsg(rectified, image.encoding, header=image.header))


def main() -> None:
    """Run the node."""
    rclpy.init()
    rclpy.spin(Rectify())
