"""Users' own rclpy nodes in the twin's process, in lock-step with simulated time."""
