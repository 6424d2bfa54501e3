"""Scenarios made in Python: the launch-like builder, robots of one file, the demo robots."""
