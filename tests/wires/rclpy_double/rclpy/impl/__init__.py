"""What rclpy has in C."""
