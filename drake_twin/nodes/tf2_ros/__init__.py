"""Stand-in for ``tf2_ros``; it lacks ``BufferClient``, which asks a buffer in another program.

Its modules export what they import, too: programs take ``TransformStamped`` from here.
"""

import importlib
from typing import Any

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.tf2_py import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)
from drake_twin.nodes.tf2_ros.buffer import Buffer
from drake_twin.nodes.tf2_ros.buffer_interface import (
    BufferInterface,
    ConvertRegistration,
    NotImplementedException,
    Stamped,
    TransformRegistration,
    TypeException,
    convert,
)
from drake_twin.nodes.tf2_ros.static_transform_broadcaster import StaticTransformBroadcaster
from drake_twin.nodes.tf2_ros.transform_broadcaster import TransformBroadcaster
from drake_twin.nodes.tf2_ros.transform_listener import TransformListener

__all__ = [
    "Buffer",
    "BufferCore",
    "BufferInterface",
    "ConnectivityException",
    "ConvertRegistration",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "NotImplementedException",
    "Stamped",
    "StaticTransformBroadcaster",
    "TimeoutException",
    "TransformBroadcaster",
    "TransformException",
    "TransformListener",
    "TransformRegistration",
    "TypeException",
    "convert",
]

_MESSAGES = {
    "Header": "std_msgs/msg/Header",
    "TFMessage": "tf2_msgs/msg/TFMessage",
    "TransformStamped": "geometry_msgs/msg/TransformStamped",
}
_OF_RCLPY = {
    "Duration": "duration",
    "DurabilityPolicy": "qos",
    "Future": "task",
    "HistoryPolicy": "qos",
    "Node": "node",
    "QoSProfile": "qos",
    "Time": "time",
}


def __getattr__(name: str) -> Any:
    if name in _MESSAGES:
        return message_class(_MESSAGES[name])
    if name in _OF_RCLPY:
        return getattr(importlib.import_module(f"drake_twin.nodes.rclpy.{_OF_RCLPY[name]}"), name)
    raise AttributeError(f"module 'tf2_ros' has no attribute {name!r}")
