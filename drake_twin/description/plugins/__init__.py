"""Gazebo plugins that become controllers, each a function."""
