"""The scenario of one robot file, once or several times in a row."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from drake_twin.dataclass import dataclass
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import robot_name_in_file
from drake_twin.description.xacro_file import xacro_arguments
from drake_twin.diagram.footprint import Footprint, footprint, height_on_ground
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.scenario import Robot, Scenario, name_in_twin

_NAMING_ARGUMENTS = ("robot_name", "prefix", "namespace")


@dataclass(frozen=True)
class PlannedScenario:
    """A scenario, and the plans of those of its robots that are already planned."""

    scenario: Scenario
    plans: tuple[RobotPlan, ...] = ()


def planned_robots(
    file: Path,
    count: int | None = None,
    *,
    xacro_args: Mapping[str, str],
    package_paths: Sequence[str] = (),
    time_step: float = 0.001,
) -> PlannedScenario:
    """Place robots of one file side by side on the ground.

    A single robot keeps the name that its file gives it, and the default of its argument ``robot_name``. Several are
    named ``robot_1``, ``robot_2``, …; where the xacro file has an argument ``robot_name``, ``prefix`` or ``namespace``
    (the first of these), it is set to match.

    Args:
        file: A xacro, URDF, SDF or MJCF file.
        count: The number of robots; None for one under its own name.
        xacro_args: Values for the file's ``<xacro:arg>``s.
        package_paths: Folders of ROS packages to search first.
        time_step: The physics step (s).

    Raises:
        InputError: If the file cannot be used.
    """
    packages = PackageIndex(package_paths)
    if count is None:
        names = [name_in_twin(robot_name_in_file(file, packages, xacro_args))]
    else:
        names = [f"robot_{index + 1}" for index in range(count)]
    naming = None if count is None else _naming_argument(file, xacro_args, packages)
    given = {**(_own_robot_name(file, packages) if count is None else {}), **xacro_args}
    robots = []
    for name in names:
        own = dict(given)
        if naming is not None:
            own[naming] = f"{name}_" if naming == "prefix" else name
        robots.append(Robot(name=name, model=str(file.absolute()), xacro_args=own))
    plan = plan_robot(robots[0], packages)
    height = height_on_ground(plan)
    spacing = _spacing(footprint(plan))
    placed = [replace(robot, xyz=(0.0, round(index * spacing, 6), height)) for index, robot in enumerate(robots)]
    scenario = Scenario(robots=tuple(placed), time_step=time_step, package_paths=tuple(package_paths))
    return PlannedScenario(scenario, (replace(plan, robot=placed[0]),))


def _own_robot_name(file: Path, packages: PackageIndex) -> dict[str, str]:
    """Return the argument ``robot_name`` with the file's own default, if it has one and that is plain text."""
    default = xacro_arguments(file, packages).get("robot_name", "")
    return {"robot_name": default} if default and "$" not in default else {}


def _naming_argument(file: Path, xacro_args: Mapping[str, str], packages: PackageIndex) -> str | None:
    if any(name in xacro_args for name in _NAMING_ARGUMENTS):
        return None
    declared = xacro_arguments(file, packages)
    return next((name for name in _NAMING_ARGUMENTS if name in declared), None)


def _spacing(room: Footprint) -> float:
    """Return twice the robot's larger side, so that it has room to turn, rounded up to 0.1 m."""
    larger = max(room.upper[0] - room.lower[0], room.upper[1] - room.lower[1])
    return max(0.5, round(2.0 * larger, 1))
