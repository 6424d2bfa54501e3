"""Stand-in for ``rclpy.validate_full_topic_name``."""

from drake_twin.nodes.rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from drake_twin.nodes.rclpy.name_rules import full_topic_problem


def validate_full_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Return True, or raise an error for a full name that ROS does not accept."""
    if (problem := full_topic_problem(name)) is not None:
        raise (InvalidServiceNameException if is_service else InvalidTopicNameException)(name, *problem)
    return True
