"""What looking ahead finds: whether commands are safe, and what goes wrong with them, when and where."""

from math import inf, pi
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.values import is_number

COLLISION, TIPPING, NOT_REACHED = "collision", "tipping", "not_reached"
POSITION_LIMIT, VELOCITY_LIMIT, EFFORT_LIMIT = "position_limit", "velocity_limit", "effort_limit"
REFUSED, FAILED = "refused", "failed"
KINDS = (COLLISION, POSITION_LIMIT, VELOCITY_LIMIT, EFFORT_LIMIT, TIPPING, REFUSED, NOT_REACHED, FAILED)


@dataclass(frozen=True)
class Problem:
    """Something that would go wrong.

    Attributes:
        time: When it is first so (s from the fork).
        kind: One of `KINDS`: ``collision``; ``position_limit``, ``velocity_limit`` or ``effort_limit`` of a joint;
            ``tipping`` of a base; ``refused`` by the twin; ``not_reached``, the end of a trajectory; ``failed``, where
            the simulation cannot continue.
        robot: The robot's name; empty where none is concerned.
        parts: The joints; or what touches, each as ``robot::link``, ``model::link``, or the name of a static model.
        text: One sentence about it.
    """

    time: float
    kind: str
    robot: str
    parts: tuple[str, ...]
    text: str

    def __str__(self) -> str:
        return f"{self.kind} in {self.time:.3f} s: {self.text}"


@dataclass(frozen=True)
class Verdict:
    """What would happen.

    Attributes:
        problems: What would go wrong, the earliest first; one of each kind and parts.
        ended: How far ahead the twin was simulated (s).
        wall_time: How long the check took in its process (s).
        steps: The number of physics steps.
    """

    problems: tuple[Problem, ...]
    ended: float
    wall_time: float
    steps: int

    @property
    def is_safe(self) -> bool:
        """Whether nothing would go wrong."""
        return not self.problems

    def of_kind(self, kind: str) -> tuple[Problem, ...]:
        """Return the problems of one of `KINDS`.

        Raises:
            InputError: If the kind is unknown.
        """
        if kind not in KINDS:
            raise InputError(f"unknown kind of problem {kind!r}", value=str(kind), valid=KINDS)
        return tuple(problem for problem in self.problems if problem.kind == kind)

    def fields(self) -> dict[str, Any]:
        """Return the verdict as plain data, for a service's response or a page."""
        return {
            "is_safe": self.is_safe,
            "problems": [{**vars(problem), "parts": [*problem.parts]} for problem in self.problems],
            "ended": self.ended,
            "wall_time": self.wall_time,
            "steps": self.steps,
        }

    def __str__(self) -> str:
        if self.is_safe:
            return f"safe for {self.ended:.3f} s"
        return "; ".join(map(str, self.problems))


@dataclass(frozen=True)
class Allowed:
    """What is not a problem.

    Attributes:
        touches: Robots, models, or links of them (``robot::link``) that may touch anything: the fingers that are to
            grasp, for example, or what they grasp.
        self_collisions: Whether links of one robot may pass through each other, as they do in the twin of a robot
            without ``<selfCollide>``.
        position: How far a joint may get beyond its limits (rad or m).
        velocity: How far a joint's speed may get beyond its limit, as a part of the limit.
        effort_time: How long a joint's servo may be at its effort limit (s).
        tilt: How far a base may tilt from its direction at the fork (rad).
        goal: How far a joint may be from the last point of its trajectory (rad or m).
        settling: How long after the end of its trajectory it may take to be there (s).

    Raises:
        InputError: If a number is below zero or not a number.
    """

    touches: tuple[str, ...] = ()
    self_collisions: bool = False
    position: float = 0.02
    velocity: float = 0.05
    effort_time: float = 0.5
    tilt: float = pi / 6
    goal: float = 0.02
    settling: float = 0.25

    def __post_init__(self) -> None:
        for name in ("position", "velocity", "effort_time", "tilt", "goal", "settling"):
            value = getattr(self, name)
            if value != inf and not is_number(value, 0.0):
                raise InputError(f"invalid {name} {value!r}: it must be a number from zero up")


class Found:
    """Gathers problems while a twin is simulated: of each kind and parts the first.

    Attributes:
        time: The present time (s from the fork).
    """

    def __init__(self) -> None:
        self.time = 0.0
        self._problems: dict[tuple[str, str, tuple[str, ...]], Problem] = {}

    def add(self, kind: str, robot: str, parts: tuple[str, ...], text: str, time: float | None = None) -> None:
        """Take note of a problem, by default at the present time."""
        problem = Problem(round(self.time if time is None else time, 9), kind, robot, parts, text)
        known = self._problems.get((kind, robot, parts))
        if known is None or problem.time < known.time:
            self._problems[kind, robot, parts] = problem

    def problems(self) -> tuple[Problem, ...]:
        """Return the problems, the earliest first."""
        return tuple(sorted(self._problems.values(), key=lambda problem: problem.time))
