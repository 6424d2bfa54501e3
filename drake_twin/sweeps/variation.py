"""What a sweep varies: paths into a scenario, and the values that they take.

A path is one of `Scenario.values` (see `drake_twin.twin.varied_parameters`), or one of these, which need another build:

| path | value |
|---|---|
| ``ground_friction``, ``gravity`` | of the world; gravity downwards (m/s²) |
| ``time_step``, ``accuracy`` | physics step (s), accuracy of ``cenic`` |
| ``ROBOT.x``, ``.y``, ``.z``, ``.roll``, ``.pitch``, ``.yaw`` | start pose (m, rad) |
| ``ROBOT.friction`` | the coefficient of friction of all its shapes |
| ``ROBOT.command_delay``, ``ROBOT.measurement_delay`` | how late commands arrive, and how old joint states are (s) |
| ``ROBOT.noise`` | a factor on the noise of all its sensors |
| ``ROBOT.args.NAME`` | a xacro argument of its file |
| ``ROBOT.JOINT.position`` | start position of a joint (rad or m) |
| ``ROBOT.JOINT.friction`` | dry friction of a joint (N·m or N) |
| ``ROBOT.CONTROLLER.PARAMETER`` | a parameter of a controller; those in mappings with dots |
| ``launch.NAME`` | an argument of the launch file that is run; see `drake_twin.sweeps.launched` |
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from math import exp, isfinite, log, prod
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.scenario import CENIC, GROUND_FRICTION, Robot, Scenario, ScenarioError
from drake_twin.twin.varied_parameters import JOINT_VALUES, LINK_VALUES

Value = float | str

_MOST = 10**15  # episodes

LAUNCH = "launch."  # what paths of launch arguments begin with

_WORLD = ("ground_friction", "gravity", "time_step", "accuracy")
_POSE = {"x": 0, "y": 1, "z": 2, "roll": 3, "pitch": 4, "yaw": 5}
_OF_ROBOT = ("friction", "noise", "command_delay", "measurement_delay")
_NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_ONE = re.compile(_NUMBER)
_NOT_FINITE = re.compile(r"[-+]?(nan|inf|infinity)", re.IGNORECASE)
_RANGE = re.compile(rf"{_NUMBER}:{_NUMBER}:(\d+)$")
_RANDOM = re.compile(rf"(\w+)\({_NUMBER},{_NUMBER}\)$")
_DISTRIBUTIONS = ("uniform", "normal", "loguniform")


def with_value(scenario: Scenario, path: str, value: Value) -> Scenario:
    """Return a scenario with one value in it.

    Args:
        scenario: The scenario.
        path: The path of the value; see this module.
        value: The value.

    Raises:
        InputError: If the path or the value cannot be used. A link, joint or controller that a robot does not have is
            found when the twin is built.
    """
    first, _, rest = path.partition(".")
    robots = {robot.name: robot for robot in scenario.robots}
    if not rest and first in (GROUND_FRICTION, *_WORLD):
        return _in_world(scenario, first, _number(path, value))
    if first not in robots or not rest:
        if path == "seed":
            raise InputError("seed: --seeds N runs each episode with the seeds 0 to N-1")
        if path.startswith(LAUNCH):
            raise InputError(f"{path}: what is run is not a launch file, so that it has no launch arguments")
        valid = [GROUND_FRICTION, *_WORLD, *(f"{name}.…" for name in robots)]
        raise InputError(f"{path}: the scenario has nothing of this name to vary", value=path, valid=valid)
    middle, _, last = rest.rpartition(".")
    is_of_part = last in (*LINK_VALUES, *JOINT_VALUES) and (middle or last == "payload")
    if is_of_part and middle not in robots[first].controller_parameters:
        return replace(scenario, values={**scenario.values, path: _number(path, value)})
    robot = _varied_robot(robots[first], path, middle, last, value)
    return replace(scenario, robots=tuple(robot if item.name == first else item for item in scenario.robots))


def _in_world(scenario: Scenario, name: str, number: float) -> Scenario:
    if name == GROUND_FRICTION:
        return replace(scenario, values={**scenario.values, name: number})
    if name == "ground_friction":
        return replace(scenario, world=replace(scenario.world, ground_friction=number))
    if name == "gravity":
        return replace(scenario, world=replace(scenario.world, gravity=(0.0, 0.0, -number)))
    if name == "accuracy" and scenario.engine != CENIC:
        raise InputError(f"accuracy: the engine {scenario.engine} has none: it is of --engine {CENIC}")
    return replace(scenario, **{name: number})  # type: ignore[arg-type]


def _varied_robot(robot: Robot, path: str, middle: str, last: str, value: Value) -> Robot:
    if not middle and last in _POSE:
        pose = [*robot.xyz, *robot.rpy]
        pose[_POSE[last]] = _number(path, value)
        return replace(robot, xyz=(pose[0], pose[1], pose[2]), rpy=(pose[3], pose[4], pose[5]))
    if not middle and last in _OF_ROBOT:
        return replace(robot, **{last: _number(path, value)})  # type: ignore[arg-type]
    if middle == "args":
        return replace(robot, xacro_args={**robot.xacro_args, last: as_text(value)})
    if last == "position":
        return replace(robot, initial_positions={**robot.initial_positions, middle: _number(path, value)})
    if last == "friction":
        return replace(robot, joint_friction={**robot.joint_friction, middle: _number(path, value)})
    controller, _, parameter = f"{middle}.{last}".partition(".")
    if not middle:
        own = [*_POSE, *_OF_ROBOT, "payload", "args.NAME"]
        parts = [f"LINK.{item}" for item in LINK_VALUES] + [f"JOINT.{item}" for item in (*JOINT_VALUES, "position")]
        valid = [f"{robot.name}.{item}" for item in (*own, *parts, "JOINT.friction", "CONTROLLER.PARAMETER")]
        raise InputError(f"{path}: a robot has nothing of this name to vary", value=path, valid=valid)
    known = robot.controller_parameters.get(controller, {})
    return replace(
        robot, controller_parameters={**robot.controller_parameters, controller: {**known, parameter: value}}
    )


def as_text(value: Value) -> str:
    """Return a value as the text of an argument of a file."""
    return value if isinstance(value, str) else f"{value:.15g}"


def _number(path: str, value: Value) -> float:
    if isinstance(value, str):
        raise InputError(f"{path}: {value!r} is not a number")
    return value


@dataclass(frozen=True)
class Variation:
    """One ``--vary PATH=…``: a list of values, or a distribution to draw them from.

    Attributes:
        path: The path of the value.
        values: The values, in order; empty for a distribution.
        distribution: ``uniform``, ``normal`` or ``loguniform``; empty for a list.
        bounds: Its lower and upper end, or mean and standard deviation.
    """

    path: str
    values: tuple[Value, ...] = ()
    distribution: str = ""
    bounds: tuple[float, float] = (0.0, 0.0)

    @classmethod
    def parse(cls, text: str) -> "Variation":
        """Read ``PATH=a,b,c``, ``PATH=a:b:n``, ``PATH=uniform(a,b)``, ``normal(m,s)`` or ``loguniform(a,b)``.

        Raises:
            InputError: If the text is not one of these.
        """
        path, equals, spec = (part.strip() for part in text.partition("="))
        if not equals or not path or not spec:
            raise InputError(
                f"--vary {text}: it must read PATH=VALUES, for example friction=0.3:1.0:8 or friction=0.3,1"
            )
        if found := _RANGE.match(spec):
            return cls(path, _once(text, _range(text, _finite(text, found[1]), _finite(text, found[2]), int(found[3]))))
        if "(" in spec:
            found = _RANDOM.match(spec.replace(" ", ""))
            name = spec.partition("(")[0].strip()
            if found is None or found[1] not in _DISTRIBUTIONS:
                what = f"--vary {text}: this is not a distribution with two numbers"
                raise InputError(what, value=name, valid=[f"{item}(a,b)" for item in _DISTRIBUTIONS])
            return cls(path, (), found[1], _checked(text, found[1], _finite(text, found[2]), _finite(text, found[3])))
        return cls(path, _once(text, _values(text, path, [word.strip() for word in spec.split(",")])))

    def at(self, share: float) -> float:
        """Return the value of a distribution below which a share (0 to 1) of its values lie."""
        one, two = self.bounds
        if self.distribution == "uniform":
            return one + share * (two - one)
        if self.distribution == "loguniform":
            return exp(log(one) + share * (log(two) - log(one)))
        from scipy.stats import norm

        return float(norm.ppf(min(max(share, 1e-9), 1 - 1e-9), one, two))


def _range(text: str, first: float, last: float, count: int) -> tuple[Value, ...]:
    if count < 2:
        raise InputError(f"--vary {text}: a range FIRST:LAST:COUNT needs two values or more")
    if count > 10**6:
        raise InputError(f"--vary {text}: a range has a million values at most")
    step = (last - first) / (count - 1)
    return (*(first + index * step for index in range(count - 1)), last)


def _checked(text: str, name: str, one: float, two: float) -> tuple[float, float]:
    if name == "normal" and not two > 0:
        raise InputError(f"--vary {text}: the standard deviation {two:g} is not above zero")
    if name != "normal" and not one < two:
        raise InputError(f"--vary {text}: the first number must be less than the second one")
    if name == "loguniform" and not one > 0:
        raise InputError(f"--vary {text}: {one:g} is not above zero, so that it has no logarithm")
    return one, two


def _values(text: str, path: str, words: Sequence[str]) -> tuple[Value, ...]:
    """Return the words of a list as numbers if all are; an argument's only if its file reads the same text."""
    if not all(words):
        raise InputError(f"--vary {text}: a value is missing")
    is_argument = path.startswith(LAUNCH) or ".args." in path
    if not is_argument and all(_NOT_FINITE.fullmatch(word) or _ONE.fullmatch(word) for word in words):
        return tuple(_finite(text, word) for word in words)
    if all(_ONE.fullmatch(word) and isfinite(float(word)) and as_text(float(word)) == word for word in words):
        return tuple(map(float, words))
    return tuple(words)


def _finite(text: str, word: str) -> float:
    number = float(word)
    if not isfinite(number):
        raise InputError(f"--vary {text}: {word} is not a finite number")
    return number


def _once(text: str, values: tuple[Value, ...]) -> tuple[Value, ...]:
    """Return values, each of which stands there once: an episode is known by its values."""
    known: set[Value] = set()
    for value in values:
        if value in known:
            raise InputError(f"--vary {text}: the value {as_text(value)} stands there twice")
        known.add(value)
    return values


@dataclass(frozen=True)
class Episode:
    """One episode of a sweep.

    Attributes:
        number: Its number in the sweep, from 0.
        values: Path → value.
        seed: What the noise of sensors is drawn from.
    """

    number: int
    values: Mapping[str, Value]
    seed: int

    def scenario(self, base: Scenario, *, launched: bool = False) -> Scenario:
        """Return the episode's scenario.

        Args:
            base: The scenario without the varied values.
            launched: Whether the values of launch arguments are in it already.

        Raises:
            InputError: If a path or a value cannot be used.
        """
        scenario = base
        for path, value in self.values.items():
            if launched and path.startswith(LAUNCH):
                continue
            try:
                scenario = with_value(scenario, path, value)
            except ScenarioError as error:
                raise InputError(f"{path}={value}: {error.reason}", **error.more) from None
        return scenario if scenario.seed == self.seed else replace(scenario, seed=self.seed)


@dataclass(frozen=True)
class Design:
    """The episodes of a sweep: all combinations of the lists, times the samples of the distributions, times the seeds.

    Attributes:
        variations: What is varied; each path once.
        samples: The number of joint samples of the distributions (Sobol's sequence).
        seeds: The seeds.

    Raises:
        InputError: If a path stands there twice, or there are too many episodes to count.
    """

    variations: tuple[Variation, ...]
    samples: int = 1
    seeds: tuple[int, ...] = (0,)

    def __post_init__(self) -> None:
        paths = [item.path for item in self.variations]
        twice = [path for index, path in enumerate(paths) if path in paths[:index]]
        if twice:
            raise InputError(f"--vary {twice[0]} is given twice")
        if self._count > _MOST:
            raise InputError(f"these are {self._count:,} episodes: a sweep has {_MOST:,} at most")

    @property
    def paths(self) -> tuple[str, ...]:
        """The varied paths, in the order in which they are given."""
        return tuple(item.path for item in self.variations)

    def __len__(self) -> int:
        return self._count

    @property
    def _count(self) -> int:
        lists = prod(len(item.values) for item in self.variations if not item.distribution)
        return lists * (self.samples if self._random else 1) * len(self.seeds)

    @property
    def _random(self) -> tuple[Variation, ...]:
        return tuple(item for item in self.variations if item.distribution)

    def values(self) -> dict[str, tuple[Value, ...]]:
        """Return the values that each path takes."""
        shares = _sobol(len(self._random), self.samples) if self._random else []
        found = {item.path: item.values for item in self.variations}
        for index, item in enumerate(self._random):
            found[item.path] = tuple(item.at(point[index]) for point in shares)
        return found

    def episodes(self) -> Iterator[Episode]:
        """Yield the episodes in their order: the seeds change first, then the samples, then the lists."""
        lists = [item for item in self.variations if not item.distribution]
        shares = _sobol(len(self._random), self.samples) if self._random else [()]
        number = 0
        for chosen in product(*(item.values for item in lists)):
            given = dict(zip((item.path for item in lists), chosen, strict=True))
            for point in shares:
                drawn = {item.path: item.at(share) for item, share in zip(self._random, point, strict=True)}
                values = {path: (given | drawn)[path] for path in self.paths}
                for seed in self.seeds:
                    yield Episode(number, values, seed)
                    number += 1

    def as_plain(self) -> dict[str, Any]:
        """Return the design as plain data, for comparison and for files."""
        kinds: Callable[[Variation], Any] = lambda item: (  # noqa: E731
            [item.distribution, *item.bounds] if item.distribution else list(item.values)
        )
        return {
            "vary": [[item.path, kinds(item)] for item in self.variations],
            "samples": self.samples if self._random else 1,
            "seeds": list(self.seeds),
        }


def _sobol(dimensions: int, count: int) -> Sequence[Sequence[float]]:
    """Return points of Sobol's sequence, scrambled with a fixed seed: the same in every run."""
    import warnings

    from scipy.stats import qmc

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a count that is not a power of two
        points: Sequence[Sequence[float]] = qmc.Sobol(dimensions, rng=0).random(count).tolist()
    return points
