"""The robots of a workload as the twin prepares them, which the other engines load, too."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, DiagramBuilder

from drake_twin.benchmarks.boxes import Box
from drake_twin.benchmarks.workloads import Workload
from drake_twin.dataclass import dataclass
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import RobotDescription
from drake_twin.description.world_file import read_world
from drake_twin.diagram.plant import PlantOfTwin, RobotInPlant, add_plant
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.planning.robot_plan import RobotPlan


@dataclass(frozen=True)
class Joint:
    """A commanded joint: its name and its effort limit (N·m)."""

    name: str
    effort: float


@dataclass(frozen=True)
class Prepared:
    """One robot.

    Attributes:
        urdf: Its URDF, with the paths of its collision meshes and without Drake's own elements.
        plan: Its plan.
        joints: The commanded joints.
        in_plant: The indices of its joints in the plant.
    """

    urdf: str
    plan: RobotPlan
    joints: tuple[Joint, ...]
    in_plant: RobotInPlant

    @property
    def description(self) -> RobotDescription:
        """Its joints and links."""
        return self.plan.description

    @property
    def xyz(self) -> tuple[float, float, float]:
        """Its initial position (m)."""
        return self.plan.spawn_pose.xyz


@dataclass(frozen=True)
class PreparedRobots:
    """All robots of a workload, their plant, and the boxes around them."""

    robots: tuple[Prepared, ...]
    builder: DiagramBuilder
    parts: PlantOfTwin
    boxes: tuple[Box, ...]

    @property
    def loose(self) -> list[int]:
        """The indices of the boxes that move."""
        return [index for index, box in enumerate(self.boxes) if box.mass is not None]

    @property
    def positions(self) -> np.ndarray:
        """The indices of the commanded joints in the plant's state, shape (robots, joints)."""
        return np.array(
            [[robot.in_plant.layout_in_plant.positions[joint.name] for joint in robot.joints] for robot in self.robots]
        )


def commanded(plan: RobotPlan) -> tuple[str, ...]:
    """Return the joints that the first controller with any claims."""
    return next((tuple(claim.joint for claim in item.claims) for item in plan.controllers if item.claims), ())


def centers(plant: MultibodyPlant, context: Context, loose: Sequence[int]) -> np.ndarray:
    """Return the positions of boxes' centers (m), shape (boxes, 3)."""
    bodies = [plant.GetBodyByName("link", plant.GetModelInstanceByName(f"box_{index}")) for index in loose]
    return np.array([plant.EvalBodyPoseInWorld(context, body).translation() for body in bodies]).reshape(-1, 3)


def prepare(
    workload: Workload, count: int, folder: Path, time_step: float, *, sampled_output_ports: bool = False
) -> PreparedRobots:
    """Read the robots and add them to a plant.

    Args:
        workload: The workload.
        count: The number of robots.
        folder: A folder for the world file.
        time_step: The plant's step (s).
        sampled_output_ports: As for `add_plant`.
    """
    packages = PackageIndex(())
    scenario = workload.scenario(count, folder, time_step=time_step)
    plans = [plan_robot(robot, packages) for robot in scenario.robots]
    world = None if scenario.world.file is None else read_world(scenario.world.file, packages)
    builder = DiagramBuilder()
    parts = add_plant(builder, scenario, plans, world, sampled_output_ports=sampled_output_ports)
    robots = []
    for plan in plans:
        joints = [Joint(name, plan.description.joints_by_name[name].limits.effort) for name in commanded(plan)]
        text = plan.model.drake_text.replace("file://", "")
        text = re.sub(r"<drake:(\w+)[ >].*?</drake:\1>", "", text, flags=re.DOTALL)
        robots.append(Prepared(text, plan, tuple(joints), parts.robots[plan.name]))
    return PreparedRobots(tuple(robots), builder, parts, workload.placed_boxes(count, scenario.robots))
