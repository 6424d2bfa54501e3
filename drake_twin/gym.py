"""A twin as an environment of Gymnasium: ``import drake_twin.gym; gymnasium.make("drake_twin/Rover-v0")``.

Needs the extra ``gym``.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from drake_twin.builder.demo import demo_scenario
from drake_twin.errors import InputError, RunError
from drake_twin.planning.controller_plan import ACTIVE
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.requirements import missing
from drake_twin.scenario import Scenario
from drake_twin.scenario.scenario_file import ScenarioFile
from drake_twin.sweeps.variation import with_value
from drake_twin.twin.twin import Twin
from drake_twin.values import is_number

try:
    import gymnasium
    from gymnasium.utils import EzPickle
except ImportError:
    raise missing("drake_twin.gym needs", "gymnasium") from None

Array = np.ndarray[Any, Any]
Bounds = tuple[float, float]
Observe = Callable[[Twin], Sequence[float] | Array]
Reward = Callable[[Twin], float]

_ARRAY = "std_msgs/msg/Float64MultiArray"


class TwinEnv(gymnasium.Env[Array, Array], EzPickle):
    """A scenario as an environment.

    The action is what is published on the topics of `action`, scaled from -1…1 to the limits of the joints. By default
    the observation is, for each robot, its joint positions and velocities, scaled to -1…1 where they have limits, and
    the pose and twist of a base that moves (m, quaternion w x y z, m/s, rad/s). ``reset(seed=…)`` draws the seed of the
    sensors' noise and the varied values. An episode is truncated after `duration`; it is terminated where the reward
    says so, or where the simulation fails (``info["error"]``).

    Args:
        scenario: The scenario, or its YAML file.
        action: Topic → bounds of each of its numbers; None for the joints' limits. By default the first active
            controller that takes a list of numbers.
        observation: Returns the observation.
        reward: Returns the reward of the step that was made, or reward and whether the task has ended.
        control_rate: Steps per simulated second (Hz).
        duration: The simulated time of an episode (s).
        values: Path → lower and upper end of the values that are drawn at each reset; its paths are
            those of `drake_twin.sweeps.variation`.
        camera: The robot and the sensor that `render` takes its picture from.
        render_mode: ``rgb_array``, with a camera.

    Raises:
        InputError: If an argument cannot be used.
    """

    metadata = {"render_modes": [], "render_fps": 50}  # noqa: RUF012  # Gymnasium's own form

    def __init__(
        self,
        scenario: Scenario | str | Path,
        action: Mapping[str, Bounds | None] | None = None,
        observation: Observe | None = None,
        reward: Callable[[Twin], float | tuple[float, bool]] | None = None,
        *,
        control_rate: float = 50.0,
        duration: float = 10.0,
        values: Mapping[str, Bounds] | None = None,
        camera: tuple[str, str] | None = None,
        render_mode: str | None = None,
    ):
        EzPickle.__init__(
            self, scenario, action, observation, reward, control_rate=control_rate, duration=duration, values=values,
            camera=camera, render_mode=render_mode,
        )  # fmt: skip
        if not (control_rate > 0 and math.isfinite(duration) and duration * control_rate >= 1):
            what = f"control_rate {control_rate:g} Hz and duration {duration:g} s must be above zero"
            raise InputError(f"{what}, and the duration a step's at least")
        if render_mode is not None and (render_mode != "rgb_array" or camera is None):
            raise InputError(f"render_mode {render_mode!r}: only 'rgb_array' is known, with the camera (robot, sensor)")
        self._base = scenario if isinstance(scenario, Scenario) else ScenarioFile.read(scenario).scenario
        self._values = dict(values or {})
        for path, ends in self._values.items():
            if not (isinstance(ends, Sequence) and len(ends) == 2 and all(map(is_number, ends)) and ends[0] < ends[1]):
                raise InputError(f"values: {path}: {ends!r} must be two numbers, the lower one first")
        self._scaled_state = _ScaledState()
        self._observe, self._reward = observation or self._scaled_state, reward
        self._rate, self._steps = control_rate, round(duration * control_rate)
        self._camera, self.render_mode = camera, render_mode
        if camera is not None:
            self.metadata = {"render_modes": ["rgb_array"], "render_fps": round(control_rate)}
        self._step_number = 0
        self.twin = Twin(self._scenario(np.array(list(self._values.values())).reshape(-1, 2).mean(axis=1), 0))
        self._bounds = _bounds(self.twin, action)
        count = sum(len(low) for low, _ in self._bounds.values())
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (count,), np.float32)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, self._observation().shape, np.float32)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """Begin an episode.

        Args:
            seed: What values and noise are drawn from, from now on.
            options: Path → value in place of a drawn one.

        Returns:
            The observation, and ``info`` with the drawn ``values``.
        """
        super().reset(seed=seed)
        ends = np.array(list(self._values.values())).reshape(-1, 2)
        drawn = self.np_random.uniform(ends[:, 0], ends[:, 1])
        scenario = self._scenario(drawn, int(self.np_random.integers(2**31)), options or {})
        self.twin.reset(scenario)
        self._step_number = 0
        self._begin()
        return self._observation(), {"values": dict(zip(self._values, drawn.tolist(), strict=True)) | (options or {})}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Apply an action for one period of the control rate.

        Raises:
            InputError: If the action has another shape than those of the action space.
        """
        scaled = np.asarray(action, dtype=float)
        if scaled.shape != self.action_space.shape:
            raise InputError(f"the action has the shape {scaled.shape}, but it must be {self.action_space.shape}")
        scaled = scaled.clip(-1.0, 1.0)
        begin, info, terminated = 0, {}, False
        for topic, (low, high) in self._bounds.items():
            share = (scaled[begin : begin + len(low)] + 1.0) / 2.0
            self.twin.publish(topic, low + share * (high - low))
            begin += len(low)
        self._step_number += 1
        try:
            self.twin.advance_to(self._step_number / self._rate)
        except RunError as error:
            info, terminated = {"error": str(error)}, True
        reward, ended = self._judged()
        truncated = self._step_number >= self._steps
        return self._observation(), reward, terminated or ended, truncated, info

    def render(self) -> Array | None:
        """Return the camera's picture, shape (height, width, 3); None without a render mode."""
        if self.render_mode is None or self._camera is None:
            return None
        return np.asarray(self.twin.sensor(*self._camera).image)

    def close(self) -> None:
        """Free the twin."""
        self.twin.close()

    def _begin(self) -> None:
        """Begin a task; for subclasses."""

    def _judged(self) -> tuple[float, bool]:
        found = 0.0 if self._reward is None else self._reward(self.twin)
        reward, ended = found if isinstance(found, tuple) else (found, False)
        return float(reward), bool(ended)

    def _observation(self) -> Array:
        return np.asarray(self._observe(self.twin), dtype=np.float32)

    def _scenario(self, drawn: Array, seed: int, options: Mapping[str, Any] | None = None) -> Scenario:
        scenario = replace(self._base, seed=seed)
        for path, value in {**dict(zip(self._values, drawn.tolist(), strict=True)), **(options or {})}.items():
            scenario = with_value(scenario, path, value if isinstance(value, str) else float(value))
        return scenario


class GoalEnv(TwinEnv):
    """One of the twin's own robots with a goal, drawn at each reset: a place for a rover, joint positions for an arm.

    The goal stands at the end of the observation. The reward is by how much the distance to it has fallen (m or rad).
    """

    def __init__(self, robot: str, reach: float, near: float, **more: Any):
        scenario = demo_scenario(robot, 1, drive=False, time_step=0.01)
        self._robot, self._reach, self._near = robot, reach, near
        self._name = scenario.robots[0].name
        self._goal = np.zeros(0)
        self._last = 0.0
        super().__init__(scenario, **more)
        EzPickle.__init__(self, robot, reach, near, **more)

    def _here(self) -> Array:
        reader, state = self._scaled_state.reader(self.twin, self._name), self.twin.entities.state_vector(self._name)
        here: Array = reader.layout.base_state(state)[0][4:6] if self._robot == "rover" else state[reader.positions]
        return here

    def _begin(self) -> None:
        here = self._here()
        self._goal = here + self.np_random.uniform(-self._reach, self._reach, here.shape)
        self._last = self._distance()

    def _distance(self) -> float:
        away = self._goal - self._here()
        return math.sqrt(away @ away)

    def _judged(self) -> tuple[float, bool]:
        before, self._last = self._last, self._distance()
        return before - self._last, self._last < self._near

    def _observation(self) -> Array:
        goal = self._goal if self._goal.size else self._here()
        return np.concatenate((self._observe(self.twin), goal), dtype=np.float32)


def _bounds(twin: Twin, action: Mapping[str, Bounds | None] | None) -> dict[str, tuple[Array, Array]]:
    """Return topic → lower and upper bounds of its numbers."""
    by_topic = {
        f"{plan.robot.topic_namespace}/{controller.name}/commands": (plan, controller)
        for plan in twin.built.plans
        for controller in plan.controllers
        if controller.state == ACTIVE and controller.claims
    }
    known = twin.graph.topics()
    by_topic = {topic: item for topic, item in by_topic.items() if known.get(topic) == _ARRAY}
    if action is None and not by_topic:
        raise InputError("the scenario has no active controller that takes a list of numbers: give topics by action=")
    found = {}
    for topic, given in (dict.fromkeys(list(by_topic)[:1]) if action is None else action).items():
        if topic not in by_topic:
            raise InputError(f"action: no active controller takes numbers on {topic}", value=topic, valid=by_topic)
        plan, controller = by_topic[topic]
        limits = [given or plan.description.limits_of_command(*claim) for claim in controller.claims]
        low, high = np.array(limits, dtype=float).T
        if given is not None and not low[0] < high[0]:
            raise InputError(f"action: the bounds {given} of {topic} must be two numbers, the lower one first")
        if not np.isfinite([low, high]).all() or not (low < high).all():
            raise InputError(
                f"action: the joints of {topic} have no limits: give bounds, action={{{topic!r}: (low, high)}}"
            )
        found[topic] = low, high
    return found


class _Reader:
    """Reads one robot's state, scaled, from its vector in the plant; limits and places are looked up once for each."""

    def __init__(self, twin: Twin, plan: RobotPlan):
        self.layout = twin.entities.state_layout(plan.name)
        joints = plan.description.movable_joints
        self.positions = np.array([self.layout.positions[joint.name] for joint in joints], dtype=int)
        velocities = np.array([self.layout.velocities[joint.name] for joint in joints], dtype=int)
        middle, half, fastest = _scales(plan)
        self._places = np.concatenate((self.positions, velocities))
        self._middles = np.concatenate((middle, np.zeros(len(joints))))
        self._scales = np.concatenate((half, fastest))

    def scaled(self, state: Array) -> list[Array]:
        """Return joint positions and velocities, and of a base that moves position, orientation and twist."""
        joints = (state[self._places] - self._middles) / self._scales
        if not self.layout.has_moving_base:
            return [joints]
        pose, velocity = self.layout.base_state(state)
        orientation = pose[:4] if pose[0] >= 0 else -pose[:4]
        return [joints, pose[4:], orientation, velocity[3:], velocity[:3]]


class _ScaledState:
    """The observation of the robots' states."""

    def __init__(self) -> None:
        self._readers: dict[str, _Reader] = {}

    def __call__(self, twin: Twin) -> Array:
        parts = [
            part for robot in twin.robots for part in self.reader(twin, robot).scaled(twin.entities.state_vector(robot))
        ]
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    def reader(self, twin: Twin, robot: str) -> _Reader:
        """Return the reader of a robot in the diagram of today."""
        known = self._readers.get(robot)
        if known is None or known.layout is not twin.entities.state_layout(robot):
            plan = next(plan for plan in twin.built.plans if plan.name == robot)
            known = self._readers[robot] = _Reader(twin, plan)
        return known


def _scales(plan: RobotPlan) -> tuple[Array, Array, Array]:
    """Return middle and half of the joints' ranges and their largest velocities; 0 and 1 where they have no limit."""
    limits = [joint.limits for joint in plan.description.movable_joints]
    lower, upper, fastest = (
        np.array([getattr(item, end) for item in limits], dtype=float) for end in ("lower", "upper", "velocity")
    )
    has_range = np.isfinite(lower) & np.isfinite(upper) & (lower < upper)
    with np.errstate(invalid="ignore"):
        middle, half = np.where(has_range, (lower + upper) / 2, 0.0), np.where(has_range, (upper - lower) / 2, 1.0)
    return middle, half, np.where(np.isfinite(fastest) & (fastest > 0), fastest, 1.0)


_WHEELS = {"/robot_1/forward_velocity_controller/commands": (-10.0, 10.0)}  # rad/s
_SPEEDS = {"/robot_1/forward_velocity_controller/commands": (-1.0, 1.0)}  # rad/s
_ENTRY = f"{__name__}:GoalEnv"
gymnasium.register(
    "drake_twin/Rover-v0", _ENTRY, kwargs={"robot": "rover", "reach": 2.0, "near": 0.15, "action": _WHEELS}
)
gymnasium.register(
    "drake_twin/Arm-v0", _ENTRY, kwargs={"robot": "arduinobot", "reach": 0.5, "near": 0.05, "action": _SPEEDS}
)
