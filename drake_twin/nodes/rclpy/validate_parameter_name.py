"""Stand-in for ``rclpy.validate_parameter_name``."""

from drake_twin.nodes.rclpy.exceptions import InvalidParameterException


def validate_parameter_name(name: str) -> bool:
    """Return True, or raise an error for an empty name."""
    if not name:
        raise InvalidParameterException(name)
    return True
