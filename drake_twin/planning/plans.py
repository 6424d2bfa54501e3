"""The plans of all robots of a scenario, and its world."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_models import RobotModels
from drake_twin.errors import InputError
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.progress import told
from drake_twin.scenario import Scenario, ScenarioError, World

if TYPE_CHECKING:
    from drake_twin.description.world_file import WorldFile


def world_of(world: World, packages: PackageIndex) -> "WorldFile | None":
    """Read the world of a scenario; None if it has no file.

    Raises:
        InputError: If the file is not an SDF world, or a value is invalid.
        ScenarioError: If it does not exist.
    """
    if world.file is None:
        return None
    from drake_twin.description.world_file import read_world

    try:
        return read_world(world.file, packages, world.without_models, world.model_poses, world.model_copies)
    except InputError as error:
        if error.file is not None:
            raise
        raise ScenarioError(("world", "file"), error.message, valid=error.valid, value=error.value) from None


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
