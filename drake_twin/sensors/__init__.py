"""Sensors of a robot: one kind, one file."""
