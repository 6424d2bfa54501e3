"""What controllers calculate, without a simulator: kinematics, odometry, limiters; NumPy and plain data only."""
