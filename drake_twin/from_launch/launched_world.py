"""The world and the simulator that a launch file starts."""

import shlex
from collections.abc import Sequence
from pathlib import Path

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.world_file import read_world
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind, Place
from drake_twin.from_launch.launched_controllers import words_of
from drake_twin.ros2.launched import WORLD, LaunchedProcess, WorldStart
from drake_twin.scenario import LONGEST_STEP, SHORTEST_STEP, World


def world_start(process: LaunchedProcess) -> WorldStart | None:
    """Return the simulator that a process starts; None for any other process."""
    return process.world if process.kind == WORLD else _world_of_command(process)


def launched_world(
    starts: Sequence[tuple[WorldStart, Place]], launch_file: Path, packages: PackageIndex, findings: list[Finding]
) -> tuple[World, float | None]:
    """Return the world of the simulator that is started last, and the physics step of its file (s).

    Args:
        starts: The simulators and their processes.
        launch_file: The file whose folder may contain the world.
        packages: Resolves the world's address.
        findings: Is extended by a finding if the world cannot be used.
    """
    started = next(((start.world, place) for start, place in reversed(starts) if start.world), None)
    if started is None:
        return World(), None
    name, place = started
    try:
        address = _address(name, launch_file)
        world = read_world(address, packages)
    except InputError as error:
        findings.append(Finding.at(Kind.NOT_STARTED, f"world {name}: {error}", place))
        return World(), None
    step = world.max_step_size
    usable = step is not None and SHORTEST_STEP <= step <= LONGEST_STEP
    return World(file=address), step if usable else None


def _world_of_command(process: LaunchedProcess) -> WorldStart | None:
    """Return the simulator that ``gz sim …``, ``ign gazebo …``, ``gzserver …`` or ``gazebo …`` starts."""
    from drake_twin.ros2.built_in_packages import world_of_gz_args

    words = words_of(process)
    if words[:2] in (["gz", "sim"], ["ign", "gazebo"]):
        return world_of_gz_args(shlex.join(words[2:]))
    if words[0] in ("gzserver", "gazebo"):
        files = [word for word in words[1:] if word.endswith((".world", ".sdf"))]
        return WorldStart("classic", files[0] if files else None, paused="-u" in words or "--pause" in words)
    if words[0] == "gzclient" or words[:2] == ["gz", "client"]:
        return WorldStart("classic", window_only=True)
    return None


def _address(name: str, launch_file: Path) -> str:
    """Return a world's address as in a scenario."""
    if "://" in name or Path(name).is_absolute():
        return name
    beside = launch_file.parent / name
    return str(beside.absolute()) if beside.is_file() else name
