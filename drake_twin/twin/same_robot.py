"""Whether two plans are of one robot."""

from dataclasses import replace

from drake_twin.planning.robot_plan import RobotPlan


def is_same_robot(plan: RobotPlan, other: RobotPlan | None) -> bool:
    """Return whether two plans are of one robot, which may be welded to another place, or have other parameters."""
    if other is None or plan is other:
        return plan is other
    if has_other_parameters(plan, other):
        return True
    robot, there = plan.robot, other.robot
    return plan.model.is_fixed and replace(robot, xyz=there.xyz, rpy=there.rpy) == there


def has_other_parameters(plan: RobotPlan, other: RobotPlan) -> bool:
    """Return whether two plans are of one robot at one place, whose controllers have other parameters."""
    robot, there = plan.robot, other.robot
    return robot != there and replace(robot, controller_parameters=there.controller_parameters) == there
