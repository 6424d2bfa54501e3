"""Stand-in for ``tf2_py``: the transforms of tf2, in Python."""

from drake_twin.nodes.tf2_py.buffer_core import BufferCore
from drake_twin.nodes.tf2_py.exceptions import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

__all__ = [
    "BufferCore",
    "ConnectivityException",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "TimeoutException",
    "TransformException",
]
