"""Controllers as ros2_controllers has them: one kind, one file."""
