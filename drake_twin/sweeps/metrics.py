"""What an episode is judged by: numbers of its history, and the conditions that end it early.

A metric is one of `METRICS`, or a function of a file (``NAME=FILE.py:FUNCTION``). It is given the `RunHistory` of the
episode and the messages of the topics that its attribute ``topics`` lists, and returns a number, or a mapping of names
to numbers. A condition is one of `CONDITIONS`, or a function of a file that is given the twin.
"""

import hashlib
import inspect
import re
import runpy
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from drake_twin.cli.history import RobotHistory, RunHistory
from drake_twin.dataclass import dataclass
from drake_twin.description.source_file import file_bytes
from drake_twin.errors import InputError, described
from drake_twin.twin.twin import Twin

Messages = Mapping[str, Sequence[Any]]

_SETTLED = 1e-2  # rad/s or m/s
_FALLEN = 0.5  # the cosine between a base's axis and the same axis at the start

_ODOMETRY = "nav_msgs/msg/Odometry"
_TRACKING = "control_msgs/msg/JointTrajectoryControllerState"

_NAME = re.compile(r"[\w.-]+")  # of a column


@dataclass(frozen=True)
class Metric:
    """A metric, by its name and where its function is found.

    Attributes:
        name: The name of its column.
        file: The Python file of its function; empty for a built-in one.
        function: The function's name.
    """

    name: str
    file: str = ""
    function: str = ""

    @classmethod
    def parse(cls, text: str) -> "Metric":
        """Read ``NAME`` of a built-in metric, ``NAME=FILE.py:FUNCTION`` or ``FILE.py:FUNCTION``.

        Raises:
            InputError: If the text is not one of these, or the file or its function cannot be used.
        """
        name, equals, place = text.partition("=")
        if not equals and ".py:" not in text:
            if text not in METRICS:
                raise InputError(
                    f"--metric {text}: unknown metric", value=text, valid=[*METRICS, "NAME=FILE.py:FUNCTION"]
                )
            return cls(text)
        file, function = _file_and_function("--metric", place if equals else text)
        if equals and not _NAME.fullmatch(name):
            raise InputError(f"--metric {text}: {name!r} is not the name of a column: letters, digits, '_', '-', '.'")
        metric = cls(name if equals else function, file, function)
        metric.call  # noqa: B018  # raises what is wrong with the file
        return metric

    @cached_property
    def call(self) -> Callable[[RunHistory, Messages], Any]:
        """The function.

        Raises:
            InputError: If its file cannot be imported.
        """
        return _function("--metric", self.file, self.function) if self.file else METRICS[self.name]

    def __reduce__(self) -> Any:  # without the function, which another process imports itself
        return Metric, (self.name, self.file, self.function)

    @property
    def sha256(self) -> str:
        """The hash of the file; empty for a built-in metric."""
        return _hash(self.file)

    @property
    def needs_efforts(self) -> bool:
        """Whether the function may read efforts, which take time to sample."""
        return bool(self.file) or self.name in ("energy", "max_effort")

    def topics(self, twin: Twin) -> list[str]:
        """Return the topics whose messages the metric is given."""
        kinds = getattr(self.call, "types", ())
        named = [str(topic) for topic in getattr(self.call, "topics", ())]
        known = twin.graph.topics()
        return named + [topic for topic in known if known[topic] in kinds and "ground_truth" not in topic]

    def columns(self, history: RunHistory, messages: Messages) -> dict[str, float | None]:
        """Return the metric's columns, and their values in an episode; None for what is not a finite number.

        Raises:
            InputError: If the function returns something else than numbers.
        """
        value = self.call(history, messages)
        if isinstance(value, Mapping):
            return {f"{self.name}.{key}": self._number(item) for key, item in value.items()}
        return {self.name: self._number(value)}

    def _number(self, value: Any) -> float | None:
        try:
            number = float(value)
        except (TypeError, ValueError):
            raise InputError(f"the metric {self.name} returns {value!r}, which is not a number") from None
        return number if isfinite(number) else None


@dataclass(frozen=True)
class Condition:
    """A condition that ends an episode early: ``fell``, ``settled``, or a function of a file that is given the twin."""

    text: str

    @cached_property
    def call(self) -> Callable[[Twin], Any]:
        """The function.

        Raises:
            InputError: If the condition is unknown, or its file cannot be imported.
        """
        if ".py:" in self.text:
            return _function("--until", *_file_and_function("--until", self.text))
        if self.text not in CONDITIONS:
            valid = [*CONDITIONS, "FILE.py:FUNCTION"]
            raise InputError(f"--until {self.text}: unknown condition", value=self.text, valid=valid)
        return CONDITIONS[self.text]

    def __reduce__(self) -> Any:
        return Condition, (self.text,)

    @property
    def sha256(self) -> str:
        """The hash of the file; empty for a built-in condition."""
        if ".py:" not in self.text:
            return ""
        return _hash(_file_and_function("--until", self.text)[0])


def has_fallen(twin: Twin) -> bool:
    """Return whether the base of a robot lies on its side, or below the world (1 m)."""
    for plan in twin.built.plans:
        if plan.model.is_fixed:
            continue
        pose = twin.robot_state(plan.name, with_efforts=False).base_pose
        start = _up(*plan.robot.rpy[:2])
        qw, qx, qy, qz = np.array(pose[3:]) / np.linalg.norm(pose[3:])
        now = np.array([2 * (qx * qz - qw * qy), 2 * (qy * qz + qw * qx), 1 - 2 * (qx * qx + qy * qy)])
        if float(now @ start) < _FALLEN or pose[2] < -1.0:
            return True
    return False


def is_settled(twin: Twin) -> bool:
    """Return whether no joint moves any more, after the first half second."""
    if twin.time < 0.5:
        return False
    states = (twin.robot_state(robot, with_efforts=False) for robot in twin.robots)
    return all(abs(velocity) < _SETTLED for state in states for velocity in state.velocities)


def _up(roll: float, pitch: float) -> np.ndarray:
    """Return the world's vertical in the axes of a base."""
    return np.array([-np.sin(pitch), np.sin(roll) * np.cos(pitch), np.cos(roll) * np.cos(pitch)])


def _per_robot(of_robot: Callable[[RobotHistory], float]) -> Callable[[RunHistory, Messages], Any]:
    def metric(history: RunHistory, messages: Messages) -> dict[str, float] | float:
        values = {name: of_robot(robot) for name, robot in history.robots.items()}
        return next(iter(values.values())) if len(values) == 1 else values

    return metric


def _path(poses: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(poses[:, :2], axis=0), axis=1).sum()) if len(poses) > 1 else 0.0


def _energy(robot: RobotHistory) -> float:
    power = np.abs(robot.efforts * robot.velocities).sum(axis=1)
    return float(np.sum((power[1:] + power[:-1]) / 2 * np.diff(robot.times))) if len(power) > 1 else 0.0


def _max_effort(robot: RobotHistory) -> float:
    return float(np.abs(robot.efforts).max(initial=0.0))


def _settled(robot: RobotHistory) -> float:
    moving = np.flatnonzero((np.abs(robot.velocities) >= _SETTLED).any(axis=1))
    if not len(moving):
        return 0.0
    return float(robot.times[moving[-1] + 1]) if moving[-1] + 1 < len(robot.times) else float("nan")


def _slip(history: RunHistory, messages: Messages) -> Any:
    """Return by how much the odometry's path is longer than the way gone (m), per robot with odometry."""
    found = {}
    for topic, received in messages.items():
        for name, robot in history.robots.items():
            if topic.startswith(f"/{name}/") and len(received) > 1:
                places = np.array([[item.pose.pose.position.x, item.pose.pose.position.y] for item in received])
                found[name] = _path(places) - _path(robot.base_poses)
    return (next(iter(found.values())) if len(found) == 1 else found) if found else float("nan")


def _tracking_error(history: RunHistory, messages: Messages) -> float:
    """Return the root mean square of the trajectory controllers' position errors (rad or m)."""
    errors = [np.asarray(item.error.positions, dtype=float) for received in messages.values() for item in received]
    every = np.concatenate(errors) if errors else np.zeros(0)
    return float(np.sqrt(np.mean(every**2))) if len(every) else float("nan")


_slip.types = (_ODOMETRY,)  # type: ignore[attr-defined]
_tracking_error.types = (_TRACKING,)  # type: ignore[attr-defined]

METRICS: Mapping[str, Callable[[RunHistory, Messages], Any]] = {
    "distance": _per_robot(lambda robot: _path(robot.base_poses)),
    "tracking_error": _tracking_error,
    "energy": _per_robot(_energy),
    "max_effort": _per_robot(_max_effort),
    "slip": _slip,
    "settled": _per_robot(_settled),
}
CONDITIONS: Mapping[str, Callable[[Twin], bool]] = {"fell": has_fallen, "settled": is_settled}


def _file_and_function(option: str, text: str) -> tuple[str, str]:
    file, _, function = text.rpartition(":")
    if not function.isidentifier():
        raise InputError(f"{option} {text}: it must read FILE.py:FUNCTION")
    return str(Path(file).expanduser().absolute()), function


def _function(option: str, file: str, name: str) -> Callable[..., Any]:
    """Import a function of a Python file.

    Raises:
        InputError: If the file does not exist or cannot be imported, or lacks the function.
    """
    if not Path(file).is_file():
        raise InputError(f"{option}: the file does not exist", file=file)
    if Path(file).suffix != ".py":
        raise InputError(f"{option}: this is not a Python file", file=file)
    try:
        module = runpy.run_path(file, run_name="_metrics_of_sweep")
    except (Exception, SystemExit) as error:
        raise InputError(f"{option}: the file cannot be imported ({described(error)})", file=file) from None
    own = [key for key, item in module.items() if inspect.isfunction(item) and not key.startswith("_")]
    found = module.get(name)
    if not callable(found):
        raise InputError(f"{option}: the file has no function {name!r}", file=file, value=name, valid=own)
    return found  # type: ignore[no-any-return]


def _hash(file: str) -> str:
    return hashlib.sha256(file_bytes(file)).hexdigest() if file else ""
