"""Stand-in for ``cv_bridge``: images of ROS as NumPy arrays, as OpenCV has them."""

from drake_twin.nodes.cv_bridge.core import CvBridge, CvBridgeError
from drake_twin.nodes.cv_bridge.encodings import cv_type as getCvType  # noqa: N812

__all__ = ["CvBridge", "CvBridgeError", "getCvType"]
