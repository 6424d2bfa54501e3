"""Stand-in for ``tf2_ros``; it lacks ``BufferClient``, which asks a buffer in another program."""

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
