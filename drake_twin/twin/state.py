"""The state of a diagram's robots at one moment: read by name, checked, hashed."""

import hashlib
import json
from typing import Any

from pydrake.systems.framework import Context

from drake_twin.dataclass import dataclass
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.planning.robot_plan import RobotPlan


@dataclass(frozen=True)
class RobotState:
    """One robot at one moment.

    Attributes:
        joints: The names of its movable joints, in file order.
        positions: Joint positions (rad or m).
        velocities: Joint velocities (rad/s or m/s).
        efforts: The efforts of its actuators (N·m or N); zero for a joint without one.
        base_pose: The pose of the root link in the world: x, y, z (m), qw, qx, qy, qz.
    """

    joints: tuple[str, ...]
    positions: tuple[float, ...]
    velocities: tuple[float, ...]
    efforts: tuple[float, ...]
    base_pose: tuple[float, ...]


def read_robot_state(built: TwinDiagram, context: Context, plan: RobotPlan, *, with_efforts: bool = True) -> RobotState:
    """Return the state of one robot.

    Args:
        built: The diagram.
        context: Its root context.
        plan: The robot.
        with_efforts: Whether to evaluate efforts, for which the plant solves the next step; else they are zero.
    """
    parts, plant = built.robots[plan.name], built.plant
    plant_context = plant.GetMyContextFromRoot(context)
    layout = parts.layout
    state = plant.GetPositionsAndVelocities(plant_context, parts.instance).tolist()
    efforts = [0.0] * layout.num_actuators
    if with_efforts:
        efforts = built.ports.efforts(context, plant_context, parts.instance).tolist()
    names = tuple(joint.name for joint in plan.description.movable_joints)
    root = plant.GetBodyByName(plan.model.root_body, parts.instance)
    pose = plant.EvalBodyPoseInWorld(plant_context, root)
    return RobotState(
        joints=names,
        positions=tuple(state[layout.positions[name]] for name in names),
        velocities=tuple(state[layout.velocities[name]] for name in names),
        efforts=tuple(efforts[layout.efforts[name]] if name in layout.efforts else 0.0 for name in names),
        base_pose=(*pose.translation().tolist(), *pose.rotation().ToQuaternion().wxyz().tolist()),
    )


def hash_plain(data: Any) -> str:
    """Return the SHA-256 of plain data, the same for equal data only."""
    return hashlib.sha256(json.dumps(data, sort_keys=True, separators=(",", ":")).encode()).hexdigest()
