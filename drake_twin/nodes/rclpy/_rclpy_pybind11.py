"""Stand-in for the exceptions of ``rclpy._rclpy_pybind11``, which rclpy's C++ raises."""

import builtins


class RCLError(RuntimeError):
    """Raised for what rcl refuses."""


class RCLInvalidROSArgsError(RCLError):
    """Raised for rules after ``--ros-args`` that rcl cannot parse."""


class NodeNameNonExistentError(RCLError):
    """Raised for a node that is not on the graph."""


class UnsupportedEventTypeError(RCLError):
    """Raised for an event that the middleware does not have."""


class UnknownROSArgsError(RuntimeError):
    """Raised for words after ``--ros-args`` that rcl does not know."""


class InvalidHandle(RuntimeError):
    """Raised for something that has been destroyed."""


class RCUtilsError(RuntimeError):
    """Raised for what rcutils refuses."""


class RMWError(RuntimeError):
    """Raised for what the middleware refuses."""


class NotImplementedError(builtins.NotImplementedError):
    """Raised for what the middleware does not have."""
