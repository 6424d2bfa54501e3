"""Scenarios whose files have absolute names, so that they mean the same from every working directory."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from os.path import isabs
from pathlib import Path

from drake_twin.description.package_index import PackageIndex, absolute_path
from drake_twin.errors import InputError
from drake_twin.scenario import Robot, Scenario, World


def with_absolute_files(scenario: Scenario, folder: Path) -> Scenario:
    """Return a scenario with the files that it names relative to a folder."""

    def absolute(name: str) -> str:
        return name if "://" in name else absolute_path(name if name.startswith("~") else folder / name)

    robots = (
        replace(robot, model=absolute(robot.model), controllers=tuple(map(absolute, robot.controllers)))
        for robot in scenario.robots
    )
    world = replace(scenario.world, file=scenario.world.file and absolute(scenario.world.file))
    return _with_files(scenario, tuple(robots), world, absolute)


def with_files_found(scenario: Scenario) -> Scenario:
    """Return a scenario with the files that a twin built from it now, in this working directory, would use.

    A name without a file, such as that of a built-in world, stays.
    """
    names = [name for robot in scenario.robots for name in (robot.model, *robot.controllers)]
    names += [node.executable for node in scenario.nodes if not node.package]
    if all(map(_is_absolute, (*names, *scenario.package_paths, scenario.world.file or "/"))):
        return scenario
    robots = tuple(robot_with_files_found(robot, scenario.package_paths) for robot in scenario.robots)
    found = _with_files(scenario, robots, _world(scenario), _absolute)
    return scenario if found == scenario else found


def robot_with_files_found(robot: Robot, package_paths: tuple[str, ...] = ()) -> Robot:
    """Return a robot likewise."""
    model, files = _absolute(robot.model), robot.controllers
    if not all(map(_is_absolute, files)):
        packages = PackageIndex(package_paths)
        with suppress(InputError):  # it is raised where the robot is planned
            files = tuple(str(packages.resolve_as_started(name, packages.resolve(model))) for name in files)
    is_found = (model, files) == (robot.model, robot.controllers)
    return robot if is_found else replace(robot, model=model, controllers=files)


def _world(scenario: Scenario) -> World:
    world = scenario.world
    if world.file is None or _is_absolute(world.file):
        return world
    from drake_twin.description.built_in_worlds import find_world

    file = None
    with suppress(InputError):  # it is raised where the world is read
        file = find_world(world.file, PackageIndex(scenario.package_paths))
    return world if file is None else replace(world, file=absolute_path(file))


def _with_files(
    scenario: Scenario, robots: tuple[Robot, ...], world: World, absolute: Callable[[str], str]
) -> Scenario:
    nodes = (node if node.package else replace(node, executable=absolute(node.executable)) for node in scenario.nodes)
    paths = tuple(map(absolute, scenario.package_paths))
    return replace(scenario, robots=robots, nodes=tuple(nodes), package_paths=paths, world=world)


def _is_absolute(name: str) -> bool:
    return "://" in name or isabs(name)


def _absolute(name: str) -> str:
    return name if _is_absolute(name) else absolute_path(name)
