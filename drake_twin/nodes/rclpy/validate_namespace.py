"""Stand-in for ``rclpy.validate_namespace``."""

from drake_twin.nodes.rclpy.exceptions import InvalidNamespaceException
from drake_twin.nodes.rclpy.name_rules import namespace_problem


def validate_namespace(namespace: str) -> bool:
    """Return True, or raise an error for a full namespace that ROS does not accept."""
    if (problem := namespace_problem(namespace)) is not None:
        raise InvalidNamespaceException(namespace, *problem)
    return True
