"""A launch file whose arguments a sweep varies: a scenario for each combination of them."""

import argparse
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any

from drake_twin.cli.target import find_launch_file, package_paths
from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.findings import Kind
from drake_twin.scenario import Scenario
from drake_twin.sweeps.variation import LAUNCH, Value, as_text

_KEPT = 64  # scenarios of combinations


@dataclass(frozen=True)
class LaunchFile:
    """A launch file and the arguments that are the same for all episodes.

    Attributes:
        file: Its path.
        arguments: Name and value of each argument that is not varied.
        folders: Folders of ROS packages to search first.
    """

    file: str
    arguments: tuple[tuple[str, str], ...] = ()
    folders: tuple[str, ...] = ()

    @classmethod
    def of(cls, options: argparse.Namespace, paths: Iterable[str]) -> "LaunchFile | None":
        """Return the launch file of a command line if its arguments are varied, else None.

        Args:
            options: The options of ``drake_twin.run``.
            paths: The varied paths.

        Raises:
            InputError: If a varied argument has a value on the command line, too.
        """
        varied = [path.removeprefix(LAUNCH) for path in paths if path.startswith(LAUNCH)]
        words = [item for item in options.target if ":=" not in item]
        folders = package_paths(options)
        file = find_launch_file(words, folders) if varied else None
        if file is None:
            return None
        given = dict(item.split(":=", 1) for item in options.target if ":=" in item)
        for name in varied:
            if name in given:
                raise InputError(f"--vary {LAUNCH}{name}: the command line has {name}:={given[name]} already")
        return cls(str(file), tuple(given.items()), tuple(folders))

    @classmethod
    def from_plain(cls, plain: Any) -> "LaunchFile | None":
        """Return the launch file that `as_plain` wrote; None without one."""
        if plain is None:
            return None
        file, arguments, folders = plain
        return cls(file, tuple((name, text) for name, text in arguments), tuple(folders))

    def as_plain(self) -> list[Any]:
        """Return the launch file as plain data."""
        return [self.file, [list(item) for item in self.arguments], list(self.folders)]

    def scenario(self, values: Mapping[str, Value]) -> Scenario:
        """Return the scenario of an episode, without its other values.

        Args:
            values: The values of the episode; those whose path begins with ``launch.`` are used.

        Raises:
            InputError: If the launch file cannot be used with them.
        """
        varied = ((path, as_text(value)) for path, value in values.items() if path.startswith(LAUNCH))
        return _scenario(self, tuple(varied))


@lru_cache(_KEPT)
def _scenario(launch: LaunchFile, varied: tuple[tuple[str, str], ...]) -> Scenario:
    from drake_twin.builder.launch_file import launch_file_scenario

    own = {path.removeprefix(LAUNCH): text for path, text in varied}
    scenario = launch_file_scenario(launch.file, {**dict(launch.arguments), **own}, launch.folders).scenario
    for name in own:
        unknown = f"argument {name} (no file declares it)"
        if any(item.kind is Kind.NOT_STARTED and item.what.startswith(unknown) for item in scenario.findings):
            what = f"{LAUNCH}{name}: no file declares this argument"
            raise InputError(what, file=launch.file, value=f"{LAUNCH}{name}", valid=_declared(launch))
    return without_nodes(scenario)


def _declared(launch: LaunchFile) -> list[str]:
    from drake_twin.description.package_index import PackageIndex
    from drake_twin.ros2.evaluate import declared_arguments

    declared = declared_arguments(launch.file, PackageIndex(launch.folders), dict(launch.arguments))
    return [f"{LAUNCH}{name}" for name in dict.fromkeys(item.name for item in declared)]


def without_nodes(scenario: Scenario) -> Scenario:
    """Return a scenario that has no node programs.

    Raises:
        InputError: If it has some.
    """
    if scenario.nodes:
        raise InputError("the scenario has node programs, which sweeps do not run: leave them out of it")
    return scenario
