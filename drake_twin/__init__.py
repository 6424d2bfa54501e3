"""Digital twins of ROS 2 robots in one Drake simulation."""
