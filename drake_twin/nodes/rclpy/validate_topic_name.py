"""Stand-in for ``rclpy.validate_topic_name``."""

from drake_twin.nodes.rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from drake_twin.nodes.rclpy.name_rules import topic_problem

TOPIC_SEPARATOR_STRING = "/"


def validate_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Return True, or raise an error for a name that ROS does not accept; it need not be a full one."""
    if (problem := topic_problem(name)) is not None:
        raise (InvalidServiceNameException if is_service else InvalidTopicNameException)(name, *problem)
    return True
