"""Stand-in for ``rclpy.validate_node_name``."""

from drake_twin.nodes.rclpy.exceptions import InvalidNodeNameException
from drake_twin.nodes.rclpy.name_rules import node_problem


def validate_node_name(node_name: str) -> bool:
    """Return True, or raise an error for a name that ROS does not accept."""
    if (problem := node_problem(node_name)) is not None:
        raise InvalidNodeNameException(node_name, *problem)
    return True
