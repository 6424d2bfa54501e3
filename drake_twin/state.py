"""The state of a diagram's robots at one moment: read by name, checked, hashed."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from pydrake.systems.framework import Context

from drake_twin.diagram.robot_plan import RobotPlan
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.errors import RunError


@dataclass(frozen=True)
class RobotState:
    """One robot at one moment.

    Attributes:
        joints: the names of its movable joints, in file order.
        positions: joint positions (rad or m).
        velocities: joint velocities (rad/s or m/s).
        efforts: what its actuators applied in the last step (N·m or N); zero where a joint has none.
        base_pose: the root link in the world: x, y, z (m), qw, qx, qy, qz.
    """

    joints: tuple[str, ...]
    positions: tuple[float, ...]
    velocities: tuple[float, ...]
    efforts: tuple[float, ...]
    base_pose: tuple[float, ...]


def read_robot_state(built: TwinDiagram, plant_context: Context, plan: RobotPlan) -> RobotState:
    """The state of one robot.

    Args:
        built: the diagram.
        plant_context: its plant's context.
        plan: the robot.
    """
    parts, plant = built.robots[plan.name], built.plant
    layout = parts.layout
    state = plant.GetPositionsAndVelocities(plant_context, parts.instance)
    efforts = np.asarray(plant.get_net_actuation_output_port(parts.instance).Eval(plant_context))
    names = tuple(joint.name for joint in plan.description.movable_joints)
    root = plant.GetBodyByName(plan.model.root_body, parts.instance)
    pose = plant.EvalBodyPoseInWorld(plant_context, root)
    return RobotState(
        joints=names,
        positions=tuple(float(state[layout.positions[name]]) for name in names),
        velocities=tuple(float(state[layout.velocities[name]]) for name in names),
        efforts=tuple(float(efforts[layout.efforts[name]]) if name in layout.efforts else 0.0 for name in names),
        base_pose=(*pose.translation().tolist(), *pose.rotation().ToQuaternion().wxyz().tolist()),
    )


def check_finite(built: TwinDiagram, plant_context: Context, time: float) -> None:
    """Refuses to go on with a state that is not made of finite numbers.

    Args:
        built: the diagram.
        plant_context: its plant's context.
        time: the last time at which all was well (s).

    Raises:
        RunError: names the first robot and joint, or model of the world, that is nowhere.
    """
    if np.isfinite(built.plant.GetPositionsAndVelocities(plant_context)).all():
        return
    for plan in built.plans:
        parts = built.robots[plan.name]
        state = built.plant.GetPositionsAndVelocities(plant_context, parts.instance)
        if np.isfinite(state).all():
            continue
        layout = parts.layout
        joints = [
            name
            for name, index in layout.positions.items()
            if not np.isfinite([state[index], state[layout.velocities[name]]]).all()
        ]
        what = f"joint {', '.join(joints)}" if joints else "the base"
        raise RunError(
            f"the simulation failed after {time:g} s: {what} of robot {plan.name!r} is no longer at a finite position."
            " Masses, inertias, gains or forces that differ by many orders of magnitude do this, and so does a step"
            " that is too long"
        )
    for name, instances in built.world_models.items():
        if not all(np.isfinite(built.plant.GetPositionsAndVelocities(plant_context, item)).all() for item in instances):
            raise RunError(
                f"the simulation failed after {time:g} s: model {name!r} of the world is no longer at a finite position"
            )


def hash_state(built: TwinDiagram, plant_context: Context, time: str, commands: Mapping[str, np.ndarray]) -> str:
    """SHA-256 of all that makes two runs go on alike: time, states by name, commands, active controllers.

    Args:
        built: the diagram.
        plant_context: its plant's context.
        time: the time, exactly, as text.
        commands: topic → the command last accepted.
    """
    digest = hashlib.sha256(f"{time}\n".encode())
    for plan in sorted(built.plans, key=lambda plan: plan.name):
        state = built.plant.GetPositionsAndVelocities(plant_context, built.robots[plan.name].instance)
        digest.update(f"robot {plan.name}\n".encode() + np.asarray(state, dtype="<f8").tobytes())
    for name, instances in sorted(built.world_models.items()):
        states = [built.plant.GetPositionsAndVelocities(plant_context, instance) for instance in instances]
        digest.update(f"model {name}\n".encode() + np.concatenate(states).astype("<f8").tobytes())
    for topic, item in sorted(built.commanded.items()):
        digest.update(f"active {topic} {','.join(item.controller.joints)}\n".encode())
        command = commands.get(topic)
        digest.update(b"none\n" if command is None else np.asarray(command, dtype="<f8").tobytes())
    return digest.hexdigest()
