"""Stand-in for ``rclpy.impl.implementation_singleton``: of rclpy's C++ there are exceptions and entities."""

from drake_twin.nodes.rclpy import _rclpy_pybind11 as rclpy_implementation

__all__ = ["package", "rclpy_implementation"]

package = "rclpy"
