"""Scenario → Drake diagram: the plant and its robots, one sub-diagram a robot, then clock, tf and viewer."""
