"""Scenario → RobotPlan: the controllers, drives, frames and topics of each robot."""
