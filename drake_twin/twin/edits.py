"""What is done to the things of a running world: they are spawned, deleted, put elsewhere, pushed and dragged."""

import logging
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from drake_twin.diagram.contact_shapes import reach_of
from drake_twin.errors import InputError
from drake_twin.messages import shortened
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.scenario import LONGEST_TIME, Robot, Scenario
from drake_twin.twin.entities import (
    Wrench,
    find_body,
    finite_numbers,
    make_wrench,
    set_entity_state,
    set_joint_positions,
)
from drake_twin.twin.pull import PERIOD, make_pull
from drake_twin.twin.session import Session
from drake_twin.values import is_number

_log = logging.getLogger(__name__)

_STILL = (0.0, 0.0, 0.0)


def spawn(session: Session, robot: Robot, plan: RobotPlan | None = None) -> None:
    """Add a robot, whose plan may have been made before.

    Raises:
        InputError: If there is one of its name already, or its files cannot be used; nothing is changed then.
    """
    if not isinstance(robot, Robot):
        raise InputError(f"{shortened(robot)} is not a Robot: make one with Robot(name, model)")
    if any(known.name == robot.name for known in session.scenario.robots):
        raise InputError(f"Entity [{robot.name}] already exists.")
    scenario = replace(session.scenario, robots=(*session.scenario.robots, robot))
    session.rebuild(scenario, () if plan is None else (plan,))
    session.sunk |= {robot.name: ()} | session.find_sunk((robot.name,))
    for finding in session.sunk[robot.name]:
        _log.warning("%s", finding)


def delete(session: Session, entity: str) -> None:
    """Remove a robot with its topics and commands, or a model of the world.

    Raises:
        InputError: If the robot or model is unknown, or the robot is the last one.
    """
    scenario = session.scenario
    pushes = tuple(push for push in scenario.pushes if push.entity.partition("::")[0] != entity)
    if entity not in session.robots:
        _check_model(session, entity)
        world = scenario.world
        poses = {name: pose for name, pose in world.model_poses.items() if name != entity}
        if entity in world.model_copies:
            copies = {name: model for name, model in world.model_copies.items() if name != entity}
            world = replace(world, model_copies=copies, model_poses=poses)
        else:
            world = replace(world, without_models=(*world.without_models, entity), model_poses=poses)
        session.rebuild(replace(scenario, world=world, pushes=pushes))
        return
    kept = tuple(item for item in scenario.robots if item.name != entity)
    if not (kept or scenario.nodes):
        raise InputError(f"Entity [{entity}] is the last one: a twin needs at least one robot.")
    commanded = session.built.commanded.values()
    own = {item.topic for item in commanded if item.robot == entity}
    own -= {item.topic for item in commanded if item.robot != entity}
    commands = tuple(command for command in scenario.commands if command.topic not in own)
    values = {name: value for name, value in scenario.values.items() if name.partition(".")[0] != entity}
    session.rebuild(replace(scenario, robots=kept, commands=commands, values=values, pushes=pushes))


def copy_model(session: Session, model: str, name: str, xyz: Iterable[float], rpy: Iterable[float]) -> None:
    """Add a model like one of the world.

    Raises:
        InputError: If the model is unknown, the name is taken or no name, or a value is invalid.
    """
    world = session.scenario.world
    pose = (*finite_numbers(xyz, 3, "position"), *finite_numbers(rpy, 3, "roll, pitch and yaw"))
    _check_model(session, model)
    assert session.built.world_file is not None
    if not isinstance(name, str) or not name or "::" in name:
        raise InputError(f"{shortened(name)} cannot name a model")
    if name in (*session.robots, *(item.name for item in session.built.world_file.models), *world.without_models):
        raise InputError(f"Entity [{name}] already exists.")
    x, y, z, roll, pitch, yaw = map(float, pose)
    copies = {**world.model_copies, name: world.model_copies.get(model, model)}
    poses = {**world.model_poses, name: (x, y, z, roll, pitch, yaw)}
    session.rebuild(replace(session.scenario, world=replace(world, model_copies=copies, model_poses=poses)))


def place(session: Session, entity: str, xyz: Iterable[float], rpy: Iterable[float]) -> None:
    """Put a robot or a model of the world elsewhere, at rest.

    Raises:
        InputError: If the entity is unknown or moves on driven joints, or a value is invalid.
    """
    from pydrake.math import RollPitchYaw

    x, y, z = map(float, finite_numbers(xyz, 3, "position"))
    roll, pitch, yaw = map(float, finite_numbers(rpy, 3, "roll, pitch and yaw"))
    robots = {plan.name: plan for plan in session.built.plans}
    if entity not in robots:
        _check_model(session, entity)
    is_welded = entity in robots and robots[entity].model.is_fixed and not robots[entity].description.base_joints
    if is_welded or not (entity in robots or entity in session.built.world_models):
        session.rebuild(_moved(session.scenario, entity, (x, y, z), (roll, pitch, yaw)))
        session.physics.detachable_joints.moved(entity)
    else:
        orientation = RollPitchYaw(roll, pitch, yaw).ToQuaternion().wxyz()
        move(session, entity, position=(x, y, z), orientation=orientation, linear=_STILL, angular=_STILL)


def move(session: Session, entity: str, **state: Any) -> None:
    """Set the pose or velocity of a robot or a moving model; see `set_entity_state`.

    Raises:
        InputError: If an entity does not exist or cannot be moved, or a value is invalid.
    """
    set_entity_state(session.built, session.physics.plant_context, entity, **state)
    session.physics.detachable_joints.moved(entity)


def pose_joints(session: Session, robot: str, positions: Mapping[str, float]) -> None:
    """Set joint positions (rad or m) of a robot without applying forces; its servos hold the joints there.

    Raises:
        InputError: If the robot or a joint is unknown, or a position is not a finite number.
    """
    set_joint_positions(session.built, session.physics.plant_context, session.plan(robot), positions)
    session.physics.detachable_joints.moved(robot)
    session.controls[robot].release(positions)


def push(
    session: Session,
    entity: str,
    force: Iterable[float],
    torque: Iterable[float],
    duration: float,
    reference: str,
    at: Iterable[float],
) -> None:
    """Push a link for a while.

    Raises:
        InputError: If an entity is unknown, or a value is invalid.
    """
    until = _end(session, duration)
    built, context = session.built, session.physics.plant_context
    wrench = make_wrench(built, context, entity, force, torque, until, reference, at)
    if (what := _passes_walls(session, wrench)) is not None:
        _log.warning("%s", what)
    session.wrenches.drop_ended(session.clock.time)
    session.wrenches.put((*session.wrenches.items, wrench))


def _passes_walls(session: Session, wrench: Wrench) -> str | None:
    """Say so if a force moves a robot or model in a step by more than it is thick: contact does not see that way."""
    built, context = session.built, session.physics.plant_context
    body, step, force = find_body(built, wrench.entity), built.plant.time_step(), float(np.linalg.norm(wrench.force))
    shapes = [shape.shape for shape in built.shapes if shape.body == body.index()]
    mass = built.plant.CalcTotalMass(context, [body.model_instance()])
    if step == 0.0 or not shapes or mass <= 0.0:  # CENIC takes shorter steps
        return None
    way = force / mass * step**2
    thinnest = min(reach_of(shape, axis) + reach_of(shape, -axis) for shape in shapes for axis in np.eye(3))
    if way <= thinnest / 2:
        return None
    moves = f"{force:g} N move {mass:.3g} kg by {1e3 * way:.3g} mm in a step of {1e3 * step:g} ms"
    return f"{wrench.entity}: {moves}: it may pass through walls (a shorter time_step and engine cenic do not let it)"


def drag(
    session: Session,
    entity: str,
    target: Iterable[float],
    at: Iterable[float],
    duration: float,
    stiffness: float | None,
) -> None:
    """Draw a point of a link to a point of the world with a spring.

    Raises:
        InputError: If the entity is unknown or fixed to the world, or a value is invalid.
    """
    until = _end(session, duration)
    clock, wrenches = session.clock, session.wrenches
    built, context = session.built, session.physics.plant_context
    known = next((item for item in wrenches.pulls if item.entity == str(entity)), None)
    period = clock.steps(PERIOD) * clock.time_step
    pull = make_pull(built, context, entity, target, at, until, stiffness, period, known)
    wrenches.drop_ended(clock.time)
    wrenches.put([*(item for item in wrenches.items if item is not known), pull])


def _end(session: Session, duration: float) -> float:
    if not is_number(duration) or duration < 0:
        raise InputError(f"invalid duration {duration!r} s: it must be a number from zero up")
    clock = session.clock
    return min(clock.time + max(float(duration), clock.time_step), LONGEST_TIME)


def _moved(
    scenario: Scenario, entity: str, xyz: tuple[float, float, float], rpy: tuple[float, float, float]
) -> Scenario:
    """Return a scenario in which a robot, or a model of the world, starts elsewhere."""
    if any(robot.name == entity for robot in scenario.robots):
        robots = (replace(item, xyz=xyz, rpy=rpy) if item.name == entity else item for item in scenario.robots)
        return replace(scenario, robots=tuple(robots))
    poses = {**scenario.world.model_poses, entity: (*xyz, *rpy)}
    return replace(scenario, world=replace(scenario.world, model_poses=poses))


def _check_model(session: Session, entity: str) -> None:
    """Raise `InputError` if the world has no model of the name."""
    models = [] if session.built.world_file is None else [model.name for model in session.built.world_file.models]
    if entity not in models:
        valid = [*session.robots, *models]
        raise InputError(f"Entity [{entity}] does not exist.", value=str(entity), valid=valid)
