"""The plans of all robots of a scenario."""

from collections.abc import Iterable, Mapping

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_models import RobotModels
from drake_twin.planning.robot_plan import RobotPlan, plan_robot
from drake_twin.progress import told
from drake_twin.scenario import Scenario


def plan_robots(scenario: Scenario, packages: PackageIndex, known: Iterable[RobotPlan] = ()) -> tuple[RobotPlan, ...]:
    """Plan a scenario's robots.

    Args:
        scenario: The scenario.
        packages: Resolves the addresses of files.
        known: Plans made before; a robot that has not changed since is not planned again.

    Raises:
        InputError: If a file, a joint or a controller is missing or wrong.
    """
    by_name: Mapping[str, RobotPlan] = {plan.name: plan for plan in known}
    models = RobotModels(packages)
    plans = []
    for index, robot in enumerate(told("reading", scenario.robots, lambda robot: robot.name)):
        plan = by_name.get(robot.name)
        if plan is None or plan.robot != robot:
            plan = plan_robot(robot, packages, ("robots", index), models)
        for error in plan.errors:
            raise error
        plans.append(plan)
    return tuple(plans)
