"""Scenario → Drake diagram: the plant and its robots, one sub-diagram per robot, clock, tf and viewer."""
