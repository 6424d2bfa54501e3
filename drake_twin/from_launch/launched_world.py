"""The world and the simulator that a launch file starts."""

import shlex
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import field
from pathlib import Path

from drake_twin.dataclass import dataclass
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.world_file import WorldModel, read_world
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind, Weight
from drake_twin.from_launch.launched_controllers import words_of
from drake_twin.ros2.launched import WORLD, LaunchedProcess, WorldStart
from drake_twin.scenario import LONGEST_STEP, SHORTEST_STEP, World

# What Gazebo classic loads where no world is given; that of gz-sim is nothing but the ground.
_CLASSICS_OWN = "empty.world"


@dataclass(frozen=True)
class LaunchedWorld:
    """The world that a launch file starts.

    Attributes:
        world: It, without the models that are robots.
        time_step: The physics step of its file (s), if it is usable.
        names: The names of all models in it.
        robots: The models that are robots.
        sensing: The other models that have sensors.
        process: What starts it.
    """

    world: World = field(default_factory=World)
    time_step: float | None = None
    names: frozenset[str] = frozenset()
    robots: tuple[WorldModel, ...] = ()
    sensing: tuple[WorldModel, ...] = ()
    process: LaunchedProcess | None = None


def world_start(process: LaunchedProcess) -> WorldStart | None:
    """Return the simulator that a process starts; None for any other process."""
    return process.world if process.kind == WORLD else _world_of_command(process)


def launched_world(
    starts: Sequence[tuple[WorldStart, LaunchedProcess]],
    launch_file: Path,
    packages: PackageIndex,
    findings: list[Finding],
) -> LaunchedWorld:
    """Return the world of the simulator that is started last; Gazebo classic's own is ``empty.world``.

    Args:
        starts: The simulators and their processes.
        launch_file: The file whose folder may contain the world.
        packages: Resolves the world's address.
        findings: Is extended by a finding if the world cannot be used.
    """
    named = [(start.world, process) for start, process in starts if start.world]
    own = [(_CLASSICS_OWN, process) for start, process in starts if start.simulator == "classic"]
    if not (named or own):
        return LaunchedWorld()
    name, process = (named or own)[-1]
    try:
        address = _address(name, launch_file, packages)
        world = read_world(address, packages)
        if Path(name).is_absolute() and address != name:
            what = f"world {name} is not on this machine: {address} is used"
            findings.append(Finding.at(Kind.WARNING, what, process.place))
    except InputError as error:
        what = f"world {name}: {error}"
        findings.append(Finding.at(Kind.NOT_STARTED, what, process.place, weight=Weight.LOST))
        return LaunchedWorld()
    step = world.max_step_size
    usable = step is not None and SHORTEST_STEP <= step <= LONGEST_STEP
    driven = tuple(model for model in world.models if model.robot is not None)
    return LaunchedWorld(
        World(file=address, without_models=tuple(model.name for model in driven)),
        step if usable else None,
        frozenset(model.name for model in world.models),
        driven,
        tuple(model for model in world.models if model.robot is None and model.sensing),
        process,
    )


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


def _address(name: str, launch_file: Path, packages: PackageIndex) -> str:
    """Return a world's address as in a scenario; an absolute path of another machine is searched in the packages."""
    if "://" in name:
        return name
    if Path(name).is_absolute():
        if not Path(name).exists():
            with suppress(InputError):
                return str(packages.resolve_elsewhere(name, launch_file))
        return name
    beside = launch_file.parent / name
    return str(beside.absolute()) if beside.is_file() else name
