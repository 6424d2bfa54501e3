"""What a launch file starts, as frozen data: the result of `evaluate`."""

from collections.abc import Iterable, Mapping
from dataclasses import field
from pathlib import Path
from typing import Any, Literal

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.findings import Place

# A parameter's value after evaluation: ROS knows these types and lists of the first four, each of one type.
Scalar = bool | int | float | str
ParameterValue = Scalar | bytes | tuple[Scalar, ...]

NODE = "node"
PROCESS = "process"
WORLD = "world"
COMPONENT = "component"


@dataclass(frozen=True)
class ParameterText:
    """A parameter file that the launch rewrote: ``$(var …)`` filled in, keys replaced.

    Attributes:
        file: The original file.
        text: The YAML that the node reads.
    """

    file: Path
    text: str


@dataclass(frozen=True)
class WorldStart:
    """A simulator that the launch file starts.

    Attributes:
        simulator: ``gz`` or ``classic``.
        world: The world's file or name, as given; None for the simulator's own empty world.
        paused: Whether simulation time stands still at the start (gz without ``-r``, classic with ``pause``).
        window_only: Whether it is a window on another simulator.
        arguments: The launch file's arguments; empty for a command line.
    """

    simulator: Literal["gz", "classic"]
    world: str | None = None
    paused: bool = False
    window_only: bool = False
    arguments: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class LaunchedProcess:
    """One thing that the launch file starts.

    Attributes:
        kind: ``node`` (a ROS executable), ``process`` (any command), ``world`` (a simulator's launch file) or
            ``component`` (a composable node; ``executable`` is its plugin).
        package: A node's or component's package.
        executable: A node's executable, or the command's first word.
        name: The node's name where the launch file gives one; ROS otherwise uses the executable's own.
        namespace: Fully resolved, ``/`` or ``/robot_1``.
        parameters: In the order in which they apply, the later over the earlier: files, rewritten files, and
            mappings of name to value (nested names joined with ``.``).
        remappings: (from, to) as written; the first that matches wins, see `resolve`.
        arguments: The command line after the executable, without what follows ``--ros-args``.
        environment: Variables that differ from those the launch was started with; None for one that was unset.
        output: ``screen``, ``log``, ``both``, ….
        place: Where the action was written.
        start_time: Simulation time (s) at which it starts.
        ends: Whether the executable does its work and ends (``create``, ``spawner``, …), so that OnProcessExit fires.
        world: The simulator, where the kind is ``world``.
        container: A component's container, fully resolved.
        not_done: The keywords of what the launch file asks for the process and the twin never does: ``cwd``, ….
        respawn: The delay (s) after which it is started again when it has ended, and how often at most; None if it is
            not. A negative number has no end.
        key: What tells it from the other processes of its launch.
    """

    kind: str
    executable: str
    place: Place
    package: str | None = None
    name: str | None = None
    namespace: str = "/"
    parameters: tuple[Path | ParameterText | Mapping[str, ParameterValue], ...] = ()
    remappings: tuple[tuple[str, str], ...] = ()
    arguments: tuple[str, ...] = ()
    environment: Mapping[str, str | None] = field(default_factory=dict)
    output: str = "log"
    start_time: float = 0.0
    ends: bool = False
    world: WorldStart | None = None
    container: str | None = None
    not_done: tuple[str, ...] = ()
    respawn: tuple[float, int] | None = None
    key: int = field(default=0, compare=False)

    @property
    def full_name(self) -> str:
        """Namespace and name: ``/robot_1/robot_state_publisher``."""
        return absolute_name(self.name or self.executable, self.namespace)

    @property
    def what(self) -> str:
        """``package/executable``, or the command's first word."""
        return self.executable if self.package is None else f"{self.package}/{self.executable}"

    def error(self, message: str, **more: Any) -> InputError:
        """Return an error at the place where the action was written."""
        return InputError(message, file=self.place.file, line=self.place.line, **more)

    def resolve(self, name: str) -> str:
        """Return the topic or service that the node uses for a name in its source, as rcl resolves it.

        A rule matches the fully qualified name, so ``/robot_description`` does not match inside a namespace.

        Args:
            name: An absolute, relative or private (``~/commands``) name.
        """
        own = absolute_name(name, self.namespace, self.full_name)
        return remapped(own, self.namespace, self.full_name, self.remappings)


@dataclass(frozen=True)
class FailedInclude:
    """An include that was left out: what it asked for, why, and where it was written."""

    what: str
    reason: str
    place: Place


@dataclass(frozen=True)
class UnfiredHandler:
    """An event handler whose event never came: what it waits for, how many actions it holds, and where it is."""

    what: str
    actions: int
    place: Place


@dataclass(frozen=True)
class Ending:
    """What follows when a process has ended that keeps running while its launch file is evaluated.

    Attributes:
        key: The process.
        code: 0 for an end without an error, 1 for one with an error; None for any.
        processes: What starts then; their times count from there.
        log: What is printed then.
        shutdown: The reason for which the launch ends; None if it does not.
        handlers: The handlers that wait for it.
        endings: What follows when these processes have ended.
    """

    key: int
    code: int | None
    processes: tuple[LaunchedProcess, ...] = ()
    log: tuple[str, ...] = ()
    shutdown: str | None = None
    handlers: tuple[UnfiredHandler, ...] = ()
    endings: tuple["Ending", ...] = ()


@dataclass(frozen=True)
class Noted:
    """Something in a launch file: what, in words, and where it was written."""

    what: str
    place: Place


@dataclass(frozen=True)
class LaunchArgument:
    """An argument that a launch file declares.

    Attributes:
        name: Its name.
        default: Its default as ``ros2 launch --show-args`` prints it; None when it is required.
        description: What it is for, as the file describes it.
        choices: The accepted values; empty for any.
        place: Where it is declared.
    """

    name: str
    default: str | None = None
    description: str = ""
    choices: tuple[str, ...] = ()
    place: Place | None = None


@dataclass(frozen=True)
class Included:
    """An include: the launch file, the names of its arguments as written, and its place."""

    file: str
    arguments: tuple[str, ...]
    place: Place


@dataclass(frozen=True)
class Launched:
    """All that a launch file starts, and what was noted while it was evaluated.

    Attributes:
        processes: In the order in which they start.
        failed_includes: Includes that were left out because something of theirs is absent.
        absent_packages: Packages that were asked for and not found, in the order in which they were asked for.
        unfired_handlers: Event handlers whose event never came.
        undeclared_arguments: Arguments given that no file declares, each with the closest that one declares.
        lost_arguments: Arguments of includes that no file declares or reads, or that the include gives again.
        log: What LogInfo and the like print, and what was repaired or ignored.
        refused_by_ros: What ROS 2 refuses in the files, and the twin reads.
        configurations: The launch configurations at the end.
        shutdown: The reason of a Shutdown that was reached; None without one.
        shutdown_time: Its simulation time (s); None without one.
        endings: What follows when processes end that keep running.
    """

    processes: tuple[LaunchedProcess, ...] = ()
    failed_includes: tuple[FailedInclude, ...] = ()
    absent_packages: tuple[str, ...] = ()
    unfired_handlers: tuple[UnfiredHandler, ...] = ()
    undeclared_arguments: Mapping[str, str] = field(default_factory=dict)
    lost_arguments: tuple[Noted, ...] = ()
    log: tuple[str, ...] = ()
    refused_by_ros: tuple[Noted, ...] = ()
    configurations: Mapping[str, str] = field(default_factory=dict)
    shutdown: str | None = None
    shutdown_time: float | None = None
    endings: tuple[Ending, ...] = ()


def absolute_name(name: str, namespace: str, node: str = "") -> str:
    """Return a ROS name in full: ``/robot_1/x`` for ``x`` in ``/robot_1``, ``/r/n/x`` for ``~/x`` of ``/r/n``.

    Args:
        name: An absolute, relative or private name.
        namespace: The namespace, fully resolved.
        node: The node's full name, for private names.
    """
    if name.startswith("/"):
        return name
    if name == "~" or name.startswith("~/"):
        return node + name[1:]
    return f"{namespace.rstrip('/')}/{name}"


def remapped(name: str, namespace: str, node: str, remappings: Iterable[tuple[str, str]]) -> str:
    """Return the name in place of a full one; the first rule that matches wins.

    Args:
        name: The full name of a topic or a service.
        namespace: The node's namespace.
        node: The node's full name.
        remappings: The rules: (from, to), where ``NODE:from`` is for the node of this name only.
    """
    for source, target in remappings:
        of_node, colon, rest = source.partition(":")
        if colon and not rest.startswith("//"):
            if of_node.strip("/") != node.rpartition("/")[2]:
                continue
            source = rest
        if not source.startswith("__") and absolute_name(source, namespace, node) == name:
            return absolute_name(target, namespace, node)
    return name


def joined_namespace(base: str | None, namespace: str | None) -> str:
    """Return a namespace within another, absolute: one that starts with ``/`` replaces the base."""
    if not namespace:
        full = base or ""
    elif namespace.startswith("/") or not base:
        full = namespace
    else:
        full = f"{base.rstrip('/')}/{namespace}"
    return "/" + full.strip("/")
