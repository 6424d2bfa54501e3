"""Stand-in for ``rclpy.validate_topic_name``."""

from drake_twin.nodes.rclpy.names import full_name


def validate_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Return True, or raise an error for a name that ROS does not accept."""
    full_name(name, "/", "/node", is_service=is_service)
    return True
