"""What the robots do while they are timed: several kinds of work, so that none favors one engine."""

from collections.abc import Callable
from dataclasses import replace
from math import sin
from pathlib import Path

import numpy as np

from drake_twin.benchmarks.boxes import FRICTION, Box, world_text
from drake_twin.builder.demo import demo_scenario
from drake_twin.dataclass import dataclass
from drake_twin.scenario import DISCRETE, Command, Robot, Scenario, World

LOOK_AT = 1.3  # s; the time at which errors are measured
SAME_ERROR = 1e-3  # rad; what counts as equally accurate
LONGEST_GRID = 0.1  # s; the period at which CENIC is stopped without events


# A twin has one robot at least. This one has no shape and does not move; every engine gets it.
_POST = (
    '<robot name="post"><link name="world"/><link name="post"><inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="fixed" type="fixed"><parent link="world"/><child link="post"/></joint></robot>\n'
)


def _none(_robot: int, _time: float) -> tuple[float, ...]:
    return ()


@dataclass(frozen=True)
class Workload:
    """Robots and their commands, or boxes alone.

    Attributes:
        name: Its name in tables.
        robot: One of `drake_twin.builder.demo.DEMOS`; its joints are commanded velocities. Not for a pile.
        velocities: (number of the robot, time in s) → the velocity of each commanded joint (rad/s).
        period: The period at which the command changes (s); None if it never changes.
        boxes: The boxes around each robot.
        pile: The count → the boxes of a workload without robots, in the world frame.
        friction: The coefficient of friction of the ground and the boxes.
        timed_from: The time from which it is timed beside other engines (s), a multiple of 0.1.
    """

    name: str
    robot: str = ""
    velocities: Callable[[int, float], tuple[float, ...]] = _none
    period: float | None = None
    boxes: tuple[Box, ...] = ()
    pile: Callable[[int], tuple[Box, ...]] | None = None
    friction: float = FRICTION
    timed_from: float = 0.3

    def commands(self, count: int, time: float) -> np.ndarray:
        """Return the commands of all robots at a time (s), shape (robots, joints)."""
        return np.array([self.velocities(index, time) for index in range(count if self.pile is None else 1)])

    def scenario(
        self, count: int, folder: Path, *, time_step: float, engine: str = DISCRETE, accuracy: float = 1e-3
    ) -> Scenario:
        """Return the twin's scenario of this workload, without commands.

        Args:
            count: The number of robots, or of boxes or towers of a pile.
            folder: The folder for the files that it names.
            time_step: As in `Scenario`.
            engine: As in `Scenario`.
            accuracy: As in `Scenario`.
        """
        if self.pile is None:
            scenario = demo_scenario(self.robot, count, drive=False, time_step=time_step)
        else:
            post = folder / "post.urdf"
            post.write_text(_POST, encoding="utf-8")
            scenario = Scenario(robots=(Robot("post", str(post)),), time_step=time_step)
        scenario = replace(scenario, engine=engine, accuracy=accuracy)
        boxes = self.placed_boxes(count, scenario.robots)
        if not boxes:
            return scenario
        file = folder / f"{self.name.replace(' ', '_')}_{count}.sdf"
        file.write_text(world_text(boxes, self.friction), encoding="utf-8")
        return replace(scenario, world=World(file=str(file)))

    def placed_boxes(self, count: int, robots: tuple[Robot, ...]) -> tuple[Box, ...]:
        """Return all boxes, in the world frame.

        Args:
            count: The count of a pile.
            robots: The robots around which boxes stand.
        """
        if self.pile is not None:
            return self.pile(count)
        return tuple(
            replace(box, xyz=(robot.xyz[0] + box.xyz[0], robot.xyz[1] + box.xyz[1], box.xyz[2]))
            for robot in robots
            for box in self.boxes
        )

    def scheduled(self, scenario: Scenario, until: float) -> Scenario:
        """Return a scenario with the workload's commands up to a time (s)."""
        times = [0.0] if self.period is None else [index * self.period for index in range(int(until / self.period) + 1)]
        return replace(
            scenario,
            commands=tuple(
                Command(f"/{robot.name}/forward_velocity_controller/commands", self.velocities(index, time), time)
                for time in times
                for index, robot in enumerate(scenario.robots)
            ),
        )


def _wander(robot: int, time: float) -> tuple[float, ...]:
    left, right = 5.0 + 3.0 * sin(2.0 * time + robot), 5.0 + 3.0 * sin(3.1 * time + 2.0 * robot)
    return left, right, left, right


def _straight(robot: int, _time: float) -> tuple[float, ...]:
    speed = 5.5 + 0.5 * (robot % 3)
    return speed, speed, speed, speed


def _over(robot: int, time: float) -> tuple[float, ...]:
    """Return velocities with a slow start, so that the obstacles count and not the slip of the wheels."""
    speed = 1.0 if time < 0.1 else 4.0 + 0.3 * (robot % 3)
    return speed, speed, speed, speed


def _wave(robot: int, time: float) -> tuple[float, ...]:
    return (
        0.5 * sin(3.0 * time + robot),
        0.4 * sin(2.3 * time + 2.0 * robot),
        0.4 * sin(4.1 * time + 0.5 * robot),
        0.2 * sin(5.0 * time),
    )


def _hold(_robot: int, _time: float) -> tuple[float, ...]:
    return 0.0, 0.0, 0.0, 0.0


def _sweep(robot: int, _time: float) -> tuple[float, ...]:
    return 0.7 + 0.05 * (robot % 3), 0.05, 0.0, 0.0


STEP_AND_RAMP = (
    Box((0.30, 1.0, 0.04), (0.50, 0.0, 0.0)),
    Box((0.60, 1.0, 0.04), (1.05, 0.0, 0.02), rpy=(0.0, -0.12, 0.0)),
)
PILLAR = (Box((0.08, 0.08, 0.50), (0.26, 0.14, 0.25), mass=0.5),)

HOLDING_ARMS = Workload("arms that hold", "arduinobot", _hold)

WORKLOADS = {
    workload.name: workload
    for workload in (
        Workload("cruising rovers", "rover", _straight),
        Workload("rovers whose commands change", "rover", _wander, period=0.1),
        Workload("rovers over steps and ramps", "rover", _over, period=0.1, boxes=STEP_AND_RAMP, timed_from=0.5),
        Workload("arms whose commands change", "arduinobot", _wave, period=0.1),
        Workload("arms that push boxes", "arduinobot", _sweep, boxes=PILLAR, timed_from=0.5),
    )
}
