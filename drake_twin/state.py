"""The state of a diagram's robots at one moment: read by name, checked, hashed."""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np
from pydrake.systems.framework import Context

from drake_twin.diagram.robot_plan import RobotPlan
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.systems.controller import PeriodicController


@dataclass(frozen=True)
class RobotState:
    """One robot at one moment.

    Attributes:
        joints: the names of its movable joints, in file order.
        positions: joint positions (rad or m).
        velocities: joint velocities (rad/s or m/s).
        efforts: what its actuators apply (N·m or N); zero where a joint has none.
        base_pose: the root link in the world: x, y, z (m), qw, qx, qy, qz.
    """

    joints: tuple[str, ...]
    positions: tuple[float, ...]
    velocities: tuple[float, ...]
    efforts: tuple[float, ...]
    base_pose: tuple[float, ...]


def read_robot_state(built: TwinDiagram, context: Context, plan: RobotPlan, *, with_efforts: bool = True) -> RobotState:
    """The state of one robot.

    Args:
        built: the diagram.
        context: its root context.
        plan: the robot.
        with_efforts: whether to ask for efforts, for which the plant solves the step to come; else they are zero.
    """
    parts, plant = built.robots[plan.name], built.plant
    plant_context = plant.GetMyContextFromRoot(context)
    layout = parts.layout
    state = plant.GetPositionsAndVelocities(plant_context, parts.instance)
    efforts = np.zeros(layout.num_actuators)
    if with_efforts:
        publisher = built.parts[plan.name].joint_states
        efforts = publisher.efforts(publisher.GetMyContextFromRoot(context))
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


def hash_state(
    built: TwinDiagram,
    context: Context,
    time: str,
    controllers: Mapping[str, Mapping[str, str]],
    commands: Mapping[str, Any],
    wrenches: Sequence[Any] = (),
) -> str:
    """SHA-256 of all that makes two runs go on alike: time, states by name, controllers, commands.

    Args:
        built: the diagram.
        context: its root context.
        time: the time, exactly, as text.
        controllers: robot → loaded controller → whether it is active.
        commands: topic → the message that holds.
        wrenches: what pushes links.
    """
    digest = hashlib.sha256(f"{time}\n".encode())
    plant_context = built.plant.GetMyContextFromRoot(context)
    for plan in sorted(built.plans, key=lambda plan: plan.name):
        state = built.plant.GetPositionsAndVelocities(plant_context, built.robots[plan.name].instance)
        digest.update(f"robot {plan.name}\n".encode() + np.asarray(state, dtype="<f8").tobytes())
        parts = built.parts[plan.name]
        values: list[Any] = [sorted(controllers[plan.name].items())]
        if parts.servo is not None:
            values.append(parts.servo.assignment(parts.servo.GetMyContextFromRoot(context)))
        for name, controller in sorted(parts.controllers.items()):
            if isinstance(controller, PeriodicController):
                values.append((name, controller.sample(controller.GetMyContextFromRoot(context))))
        for part in _bytes_of(values):
            digest.update(part)
    for name, instances in sorted(built.world_models.items()):
        states = [built.plant.GetPositionsAndVelocities(plant_context, instance) for instance in instances]
        digest.update(f"model {name}\n".encode() + np.concatenate(states).astype("<f8").tobytes())
    for part in _bytes_of([sorted(commands.items()), *([list(wrenches)] if wrenches else [])]):
        digest.update(part)
    return digest.hexdigest()


def _bytes_of(value: Any) -> Iterator[bytes]:
    """A plain, frozen value as bytes that are equal for equal values and for no others."""
    if is_dataclass(value) and not isinstance(value, type):
        yield f"{type(value).__name__}(".encode()
        for item in fields(value):
            yield from _bytes_of(getattr(value, item.name))
        yield b")"
    elif isinstance(value, np.ndarray):
        yield f"{value.dtype.str}{value.shape}".encode()
        yield value.tobytes()
    elif isinstance(value, Mapping):
        yield b"{"
        for key, item in value.items():
            yield from _bytes_of(key)
            yield from _bytes_of(item)
        yield b"}"
    elif isinstance(value, list | tuple):
        yield b"["
        for item in value:
            yield from _bytes_of(item)
        yield b"]"
    else:
        yield f"{value.hex() if isinstance(value, float) else repr(value)},".encode()
