"""Stand-in for ``rclpy.destroyable``."""


class DestroyableType:
    """Something that can be destroyed."""
