"""Scenario to RobotPlan: which controllers, drives, frames and topics each robot has."""
