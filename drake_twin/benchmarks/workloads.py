"""What the robots do while they are timed: several kinds of work, so that none favors one engine."""

from collections.abc import Callable
from dataclasses import replace
from math import sin
from pathlib import Path

import numpy as np

from drake_twin.builder.demo import demo_scenario
from drake_twin.dataclass import dataclass
from drake_twin.scenario import DISCRETE, Command, Robot, Scenario, World

LOOK_AT = 1.3  # s; the time at which errors are measured
SAME_ERROR = 1e-3  # rad; what counts as equally accurate
LONGEST_GRID = 0.1  # s; the period at which CENIC is stopped without events


@dataclass(frozen=True)
class Box:
    """A box near a robot.

    Attributes:
        size: The lengths of its edges (m).
        xyz: Its center relative to the robot's initial position on the ground (m).
        pitch: Its angle about the robot's y axis (rad).
        mass: Its mass (kg); None for a fixed box.
    """

    size: tuple[float, float, float]
    xyz: tuple[float, float, float]
    pitch: float = 0.0
    mass: float | None = None


@dataclass(frozen=True)
class Workload:
    """Robots and their commands.

    Attributes:
        name: Its name in tables.
        robot: One of `drake_twin.builder.demo.DEMOS`; its joints are commanded velocities.
        velocities: (number of the robot, time in s) → the velocity of each commanded joint (rad/s).
        period: The period at which the command changes (s); None if it never changes.
        boxes: The boxes around each robot.
    """

    name: str
    robot: str
    velocities: Callable[[int, float], tuple[float, ...]]
    period: float | None = None
    boxes: tuple[Box, ...] = ()

    def commands(self, count: int, time: float) -> np.ndarray:
        """Return the commands of all robots at a time (s), shape (robots, joints)."""
        return np.array([self.velocities(index, time) for index in range(count)])

    def scenario(
        self, count: int, folder: Path, *, time_step: float, engine: str = DISCRETE, accuracy: float = 1e-3
    ) -> Scenario:
        """Return the twin's scenario of this workload, without commands.

        Args:
            count: The number of robots.
            folder: The folder for the world file.
            time_step: As in `Scenario`.
            engine: As in `Scenario`.
            accuracy: As in `Scenario`.
        """
        scenario = demo_scenario(self.robot, count, drive=False, time_step=time_step)
        scenario = replace(scenario, engine=engine, accuracy=accuracy)
        if not self.boxes:
            return scenario
        file = folder / f"{self.name.replace(' ', '_')}_{count}.sdf"
        file.write_text(_world(self.placed_boxes(scenario.robots)), encoding="utf-8")
        return replace(scenario, world=World(file=str(file)))

    def placed_boxes(self, robots: tuple[Robot, ...]) -> tuple[Box, ...]:
        """Return the boxes of all robots, in the world frame."""
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


def _world(boxes: tuple[Box, ...]) -> str:
    models = []
    for index, box in enumerate(boxes):
        size = " ".join(map(str, box.size))
        inertial = ""
        if box.mass is not None:
            x, y, z = (edge * edge for edge in box.size)
            ixx, iyy, izz = (box.mass / 12 * moment for moment in (y + z, x + z, x + y))
            inertial = (
                f"<inertial><mass>{box.mass}</mass><inertia><ixx>{ixx}</ixx><iyy>{iyy}</iyy><izz>{izz}</izz>"
                "<ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>"
            )
        geometry = f"<geometry><box><size>{size}</size></box></geometry>"
        pose = f"{' '.join(map(str, box.xyz))} 0 {box.pitch} 0"
        models.append(
            f'<model name="box_{index}"><static>{str(box.mass is None).lower()}</static><pose>{pose}</pose>'
            f'<link name="link">{inertial}<collision name="c">{geometry}</collision>'
            f'<visual name="v">{geometry}</visual></link></model>'
        )
    ground = (
        '<model name="ground"><static>true</static><link name="link"><collision name="c"><geometry><plane>'
        "<normal>0 0 1</normal><size>100 100</size></plane></geometry></collision></link></model>"
    )
    return f'<sdf version="1.9"><world name="benchmark">{ground}{"".join(models)}</world></sdf>\n'


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
    Box((0.60, 1.0, 0.04), (1.05, 0.0, 0.02), pitch=-0.12),
)
PILLAR = (Box((0.08, 0.08, 0.50), (0.26, 0.14, 0.25), mass=0.5),)

HOLDING_ARMS = Workload("arms that hold", "arduinobot", _hold)

WORKLOADS = {
    workload.name: workload
    for workload in (
        Workload("cruising rovers", "rover", _straight),
        Workload("rovers whose commands change", "rover", _wander, period=0.1),
        Workload("rovers over steps and ramps", "rover", _over, period=0.1, boxes=STEP_AND_RAMP),
        Workload("arms whose commands change", "arduinobot", _wave, period=0.1),
        Workload("arms that push boxes", "arduinobot", _sweep, boxes=PILLAR),
    )
}
