"""Programs that run beside the robots, and what follows when they end."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field

from drake_twin.dataclass import dataclass
from drake_twin.saved import saved


@saved("Respawn")
@dataclass(frozen=True)
class Respawn:
    """How a node program is started again when it has ended.

    Attributes:
        delay: The simulation time (s) from its end to its start.
        max_retries: How often at most; negative for no end.
    """

    delay: float = 0.0
    max_retries: int = -1


@saved("OnExit")
@dataclass(frozen=True)
class OnExit:
    """What follows when a node program has ended.

    Attributes:
        exit_code: 0 for an end without an error, 1 for one with an error; None for any.
        nodes: The programs that start then; their times count from there.
        log: What is printed.
        shutdown: The reason for which the run ends; None if it continues.
    """

    exit_code: int | None = None
    nodes: tuple["NodeProgram", ...] = ()
    log: tuple[str, ...] = ()
    shutdown: str | None = None


@saved("NodeProgram")
@dataclass(frozen=True)
class NodeProgram:
    """A rclpy program of the user's that runs beside the robots, in the twin's process.

    Attributes:
        executable: A Python script; with a package, the name of its program as for ``ros2 run``.
        package: The ROS package; empty for a script.
        arguments: The command line. What follows ``--ros-args`` names the node, remaps its topics and sets parameters.
        environment: Variables that differ from those of the process.
        time: The simulation time at which it starts (s).
        respawn: How it is started again when it has ended; None if it is not.
        on_exit: What follows when it has ended.
    """

    executable: str
    package: str = ""
    arguments: tuple[str, ...] = ()
    environment: Mapping[str, str] = field(default_factory=dict)
    time: float = 0.0
    respawn: Respawn | None = None
    on_exit: tuple[OnExit, ...] = ()

    @property
    def what(self) -> str:
        """``PACKAGE/EXECUTABLE``, or the script's name."""
        return f"{self.package}/{self.executable}" if self.package else self.executable.rpartition("/")[2]


def with_later_ones(programs: Iterable[NodeProgram]) -> Iterator[NodeProgram]:
    """Yield node programs, each with those that start after it."""
    for program in programs:
        yield program
        for after in program.on_exit:
            yield from with_later_ones(after.nodes)
