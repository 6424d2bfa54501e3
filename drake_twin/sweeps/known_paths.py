"""The paths that a robot's files have: for those that a user mistypes."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from difflib import get_close_matches

from drake_twin.controllers.registry import controller_class
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.parameters import parameter_names
from drake_twin.description.xacro_file import xacro_arguments
from drake_twin.errors import InputError
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.scenario import Scenario
from drake_twin.twin.varied_parameters import JOINT_VALUES, LINK_VALUES

_OF_MOTOR = tuple(value for value in JOINT_VALUES if value != "damping")
_SHOWN = 6  # of close paths
_LEAST_LIKENESS = 0.5


def check_paths(varied: Scenario, base: Scenario, paths: Iterable[str]) -> None:
    """Check that the controllers, parameters and xacro arguments exist that paths name.

    A path that is of nothing else is read as a controller's parameter. Controllers and xacro ignore what they do not
    know.

    Args:
        varied: A scenario with values at the paths.
        base: The scenario without them.
        paths: The paths.

    Raises:
        InputError: If a robot has no controller of a name, a controller no parameter, or a file no argument; the text
            has close paths.
    """
    before = {robot.name: robot for robot in base.robots}
    packages = PackageIndex(varied.package_paths)
    for index, robot in enumerate(varied.robots):
        known = before.get(robot.name, robot)
        if (robot.controller_parameters, robot.xacro_args) == (known.controller_parameters, known.xacro_args):
            continue
        plain = replace(robot, controller_parameters=known.controller_parameters)
        plan = plan_robot(plain, packages, ("robots", index))
        controllers = {item.name for item in plan.controllers}
        for path in paths:
            owner, _, rest = path.partition(".")
            name, _, parameter = rest.partition(".")
            if owner == robot.name and name == "args" and plan.description.file is not None:
                arguments = [f"{owner}.args.{item}" for item in xacro_arguments(plan.description.file, packages)]
                if path not in arguments:
                    raise InputError(f"{path}: the robot's file has no such argument", value=path, valid=arguments)
            if owner != robot.name or parameter not in robot.controller_parameters.get(name, {}):
                continue
            if name not in controllers:
                what = f"{path}: robot {robot.name!r} has no controller {name!r}, and its parts no such value"
                raise InputError(what, value=path, valid=_close(path, _all_paths(plan)))
            valid = [*_parameters(plan, name)]
            if valid and not any(_fits(path, item) for item in valid):
                raise InputError(f"{path}: controller {name!r} has no parameter {parameter!r}", value=path, valid=valid)


def _close(path: str, known: Iterable[str]) -> list[str]:
    every = [*known]
    return get_close_matches(path, every, _SHOWN, _LEAST_LIKENESS) or every


def _all_paths(plan: RobotPlan) -> Iterator[str]:
    """Yield the paths of a robot's links, joints and controllers; where the robot's name may be left out, it is."""
    parts: list[tuple[str, Sequence[str]]] = [(link, LINK_VALUES) for link in plan.description.links]
    parts += [(joint.name, ("damping",)) for joint in plan.description.movable_joints]
    parts += [(joint.name, _OF_MOTOR) for joint in plan.description.actuated_joints]
    for part, values in parts:
        yield from (f"{plan.name}.{part.removeprefix(f'{plan.name}_')}.{value}" for value in values)
    for joint in plan.description.movable_joints:
        yield from (f"{plan.name}.{joint.name}.{value}" for value in ("position", "friction"))
    for item in plan.controllers:
        yield from _parameters(plan, item.name)


def _parameters(plan: RobotPlan, controller: str) -> Iterator[str]:
    """Yield the paths of a controller's parameters; ``<joint>`` stands for any name."""
    kind = next(controller_class(item.type) for item in plan.controllers if item.name == controller)
    if kind is not None:
        for parameters in (kind.Parameters, *getattr(kind.Parameters, "dialects", ())):
            yield from (f"{plan.name}.{controller}.{name}" for name, _, _ in parameter_names(parameters))


def _fits(path: str, known: str) -> bool:
    """Return whether a path is one that is known; a name with dots may stand for ``<joint>``."""
    before, joint, after = known.partition("<joint>")
    return path == known or (bool(joint) and path.startswith(before) and path.endswith(after.rpartition("<joint>")[2]))
