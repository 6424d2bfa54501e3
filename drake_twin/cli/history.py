"""The joint states and the real-time factor over a run, as plain data; `drake_twin.cli.plot` draws it."""

import time
from dataclasses import field

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.twin.twin import Twin

SAMPLE_RATE = 50.0  # Hz of simulation time

MOST_SAMPLES = 4096  # as many as a plot can show: a longer run keeps every second sample, then every fourth, …
_MOST_WINDOWS = 100  # over which the real-time factor is averaged
_SHORTEST_WINDOW = 0.25  # s of wall time: `Twin.run` advances in bursts, thirty a second


@dataclass(frozen=True)
class RobotHistory:
    """A robot's movable joints over time.

    Attributes:
        joints: The names of the joints.
        units: ``rad`` or ``m`` for each joint.
        times: Simulation times (s), shape (T,).
        positions: Positions (rad or m), shape (T, joints).
        velocities: Velocities (rad/s or m/s), shape (T, joints).
        efforts: What the actuators apply (N·m or N), shape (T, joints).
        base_poses: The root link in the world: x, y, z (m), qw, qx, qy, qz, shape (T, 7).
    """

    joints: tuple[str, ...]
    units: tuple[str, ...]
    times: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray
    efforts: np.ndarray
    base_poses: np.ndarray = field(default_factory=lambda: np.zeros((0, 7)))


@dataclass(frozen=True)
class RunHistory:
    """A run since its start, or since the last reset.

    Attributes:
        robots: Robot name → its joints.
        window_edges: Simulation times (s) between which the real-time factor was measured, shape (W + 1,).
        real_time_factors: Simulation time over wall time, shape (W,).
    """

    robots: dict[str, RobotHistory]
    window_edges: np.ndarray
    real_time_factors: np.ndarray


@dataclass(frozen=True)
class _Sample:
    number: int
    time: float
    wall_time: float
    states: dict[str, tuple[tuple[str, ...], np.ndarray, tuple[float, ...]]]


class HistoryRecorder:
    """Samples a twin's joints on a grid of simulation times, without an effect on the run.

    Args:
        rate: Samples per second of simulation time.
        with_efforts: Whether to sample efforts, for which the plant solves a step; else they are zero.
    """

    def __init__(self, rate: float = SAMPLE_RATE, *, with_efforts: bool = True):
        self._rate, self._with_efforts = rate, with_efforts
        self._twin: Twin | None = None
        self._units: dict[str, dict[str, str]] = {}
        self._clear()

    def record(self, twin: Twin) -> None:
        """Record a twin from now on, in place of the one before."""
        if twin is self._twin:
            return
        self._twin = twin
        self._clear()
        # Every twin has the clock; joint states may be renamed, or their broadcaster inactive.
        twin.subscribe("/clock", lambda _: self._sample(twin), rate=self._rate)

    def history(self) -> RunHistory:
        """Return what was recorded so far."""
        robots: dict[str, RobotHistory] = {}
        for name, joints in {name: s.states[name][0] for s in self._samples for name in s.states}.items():
            own = [sample for sample in self._samples if sample.states.get(name, ((),))[0] == joints]
            values = np.array([sample.states[name][1] for sample in own]).reshape(len(own), 3, len(joints))
            robots[name] = RobotHistory(
                joints=joints,
                units=tuple(self._units[name][joint] for joint in joints),
                times=np.array([sample.time for sample in own]),
                positions=values[:, 0],
                velocities=values[:, 1],
                efforts=values[:, 2],
                base_poses=np.array([sample.states[name][2] for sample in own]).reshape(len(own), 7),
            )
        edges, factors = _real_time_factors(
            np.array([sample.time for sample in self._samples]),
            np.array([sample.wall_time for sample in self._samples]),
        )
        return RunHistory(robots, edges, factors)

    def _clear(self) -> None:
        self._samples: list[_Sample] = []
        self._count = 0
        self._stride = 1

    def _sample(self, twin: Twin) -> None:
        if twin is not self._twin:
            return
        if self._samples and twin.time <= self._samples[-1].time:  # it was reset
            self._clear()
        number, self._count = self._count, self._count + 1
        if number % self._stride:
            return
        states = {}
        for plan in twin.built.plans:
            if plan.name not in self._units or number == 0:
                joints = plan.description.movable_joints
                self._units[plan.name] = {joint.name: "m" if joint.type == "prismatic" else "rad" for joint in joints}
            state = twin.robot_state(plan.name, with_efforts=self._with_efforts)
            values = np.array([state.positions, state.velocities, state.efforts])
            states[plan.name] = (state.joints, values, state.base_pose)
        self._samples.append(_Sample(number, twin.time, time.perf_counter(), states))
        if len(self._samples) > MOST_SAMPLES:
            self._stride *= 2
            self._samples = [sample for sample in self._samples if sample.number % self._stride == 0]


def _real_time_factors(times: np.ndarray, wall_times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the edges of windows of enough wall time, and their factors; a short run has ten windows at least."""
    if len(times) < 2:
        return np.zeros(0), np.zeros(0)
    total = wall_times[-1] - wall_times[0]
    shortest = max(total / _MOST_WINDOWS, min(_SHORTEST_WINDOW, total / 10))
    edges = [0]
    for index in range(1, len(times)):
        if wall_times[index] - wall_times[edges[-1]] >= shortest and wall_times[index] > wall_times[edges[-1]]:
            edges.append(index)
    edges = [*(edges[:-1] or edges), len(times) - 1]  # the last window takes the rest
    spent = np.maximum(np.diff(wall_times[edges]), 1e-9)
    return times[edges], np.diff(times[edges]) / spent
