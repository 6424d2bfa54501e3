"""Robots for tests of looking ahead, and what happens to them when a plain twin does the same."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from conftest import ARM, ROVER

from drake_twin import TwinBuilder
from drake_twin.scenario import Scenario, World
from drake_twin.twin.snapshot import Snapshot
from drake_twin.twin.twin import Twin

TRAJECTORY = "/arm/joint_trajectory_controller/joint_trajectory"
FOLLOW = "/arm/joint_trajectory_controller/follow_joint_trajectory"
WHEELS = "/rover/forward_velocity_controller/commands"
JOINTS = ("joint_1", "joint_2", "joint_3")
_CONTROLLERS = "package://arduinobot_description/config/arduinobot_trajectories.yaml"


def box(name: str, xyz, size, rpy=(0, 0, 0)) -> str:
    """A static box as a model of a world."""
    pose = " ".join(map(str, (*xyz, *rpy)))
    shape = f"<geometry><box><size>{' '.join(map(str, size))}</size></box></geometry>"
    collision = f'<collision name="collision">{shape}</collision>'
    return f'<model name="{name}"><static>true</static><pose>{pose}</pose><link name="link">{collision}</link></model>'


def world(folder, *models: str, ground: bool = True) -> World:
    """A world of these models."""
    file = folder / "world.sdf"
    file.write_text(f'<sdf version="1.9"><world name="world">{"".join(models)}</world></sdf>')
    return World(file=str(file), ground=ground)


def arm(folder, *, self_collision: bool | None = True) -> Scenario:
    """An arm with a post and a low shelf beside it, which it reaches with some of its motions."""
    post, shelf = box("post", (0.1, 0.42, 0.3), (0.06, 0.06, 0.6)), box("shelf", (0.3, -0.35, 0.1), (0.3, 0.2, 0.02))
    builder = TwinBuilder(world=world(folder, post, shelf))
    builder.robot("arm", ARM, controllers=[_CONTROLLERS], self_collision=self_collision)
    return replace(builder.scenario(), islands=0)  # in another process, too, when the tests here ask for islands


def rover(folder, *models: str, xyz=(0.0, 0.0, 0.13)) -> Scenario:
    """A rover that faces x."""
    builder = TwinBuilder(world=world(folder, *models)).robot("rover", ROVER, xyz=xyz)
    return replace(builder.scenario(), islands=0)


def trajectory(*points, joints=JOINTS) -> dict:
    """A trajectory of pairs: the time from the start (s), and the positions (rad)."""
    times = [divmod(round(time * 1e9), 10**9) for time, _ in points]
    return {
        "joint_names": [*joints],
        "points": [
            {"positions": [*map(float, positions)], "time_from_start": {"sec": sec, "nanosec": nanosec}}
            for (sec, nanosec), (_, positions) in zip(times, points, strict=True)
        ],
    }


def random_trajectory(generator: np.random.Generator) -> dict:
    """Two points within the arm's ranges, as quickly as its joints may turn on the way there, or slower."""
    first, second = generator.uniform(-1.35, 1.35, (2, 3))
    pace = generator.uniform(1.0, 2.0)  # rad/s
    time = max(np.abs(first)) / pace
    return trajectory((time, first), (time + max(np.abs(second - first)) / pace, second))


def length(message: dict) -> float:
    """When a trajectory ends (s)."""
    last = message["points"][-1]["time_from_start"]
    return last["sec"] + last["nanosec"] * 1e-9


class Touch(NamedTuple):
    """When two bodies touch first (s from the snapshot), and their names in Drake; ``world`` for all that is static."""

    time: float
    bodies: frozenset[str]


def first_touch(twin: Twin, snapshot: Snapshot, topic: str, message, duration: float, but=()) -> Touch | None:
    """Let a twin really do it, step by step, and return the first touch of what does not touch at the start.

    Args:
        twin: The twin.
        snapshot: Where it begins.
        topic: Where the message is published.
        message: The message.
        duration: For how long (s).
        but: Pairs of bodies that may touch.
    """
    twin.restore(snapshot)
    start = twin.time
    known = _touching(twin) | {frozenset(pair) for pair in but}
    twin.publish(topic, message)
    while twin.time < start + duration - 1e-9:
        twin.step()
        if new := _touching(twin) - known:
            return Touch(twin.time - start, sorted(new, key=sorted)[0])
    return None


def _touching(twin: Twin) -> set[frozenset[str]]:
    results = twin.graph.evaluate(twin.built.ports.contact_results())
    inspector = twin.built.scene_graph.model_inspector()
    points = [results.point_pair_contact_info(index) for index in range(results.num_point_pair_contacts())]
    pairs = [(info.point_pair().id_A, info.point_pair().id_B) for info in points]
    for index in range(results.num_hydroelastic_contacts()):
        surface = results.hydroelastic_contact_info(index).contact_surface()
        pairs.append((surface.id_M(), surface.id_N()))
    bodies = [[twin.plant.GetBodyFromFrameId(inspector.GetFrameId(item)).name() for item in pair] for pair in pairs]
    return {frozenset(name.removeprefix("static_") for name in pair) for pair in bodies}
