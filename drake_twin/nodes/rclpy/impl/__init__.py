"""Stand-in for ``rclpy.impl``, of which nodes use the names of types."""
