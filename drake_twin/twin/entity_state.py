"""Poses and motion of robots, their links and the world's models: read and set them, apply wrenches.

Names are Gazebo's: a robot or a model of the world (``robot_1``), or one of its links (``robot_1::base_link``). Poses
and twists are in the world, or in the frame of another entity.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import isfinite

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import Context

from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.errors import InputError
from drake_twin.messages import shortened
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.saved import saved
from drake_twin.values import is_number

WORLD = "world"


@dataclass(frozen=True)
class EntityState:
    """Pose and twist of an entity in a reference frame.

    Attributes:
        position: The position x, y, z (m).
        orientation: The quaternion w, x, y, z.
        linear: The velocity of its origin (m/s).
        angular: The angular velocity (rad/s).
    """

    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float]
    linear: tuple[float, float, float]
    angular: tuple[float, float, float]


@saved("Wrench")
@dataclass(frozen=True)
class Wrench:
    """A force and a torque that act on a link for some time.

    Attributes:
        entity: The full name of the link.
        force: The force, in the world's axes (N).
        torque: The torque, in the world's axes (N·m).
        until: The simulation time at which it ends (s).
        at: The point of the link at which the force acts, in the link's frame (m).
    """

    entity: str
    force: tuple[float, float, float]
    torque: tuple[float, float, float]
    until: float
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)


def find_body(built: TwinDiagram, entity: str) -> RigidBody:
    """Return the body of an entity: a link, or a model's root link.

    Raises:
        InputError: If the entity does not exist.
    """
    plant = built.plant
    name, separator, link = str(entity).partition("::")
    plans = {plan.name: plan for plan in built.plans}
    if name in plans:
        plan, instance = plans[name], built.robots[name].instance
        own = drake_link_name(link) if separator else plan.model.root_body
        if plant.HasBodyNamed(own, instance):
            return plant.GetBodyByName(own, instance)
        raise InputError(f"robot {name!r} has no link {link!r}", value=link, valid=plan.description.links)
    if name in built.world_models:
        bodies = [plant.get_body(i) for item in built.world_models[name] for i in plant.GetBodyIndices(item)]
        for body in bodies:
            if not separator or body.name() == link:
                return body
        raise InputError(f"model {name!r} has no link {link!r}", value=link, valid=[body.name() for body in bodies])
    valid = [*plans, *built.world_models]
    raise InputError(f"Entity [{entity}] does not exist.", value=str(entity), valid=valid)


def exists(built: TwinDiagram, entity: str) -> bool:
    """Return whether there is an entity of a name."""
    try:
        find_body(built, entity)
    except InputError:
        return False
    return True


def _free_bodies(built: TwinDiagram, entity: str) -> list[RigidBody]:
    """Return the bodies of a robot or model that float; none of a link."""
    instances = (built.robots[entity].instance,) if entity in built.robots else built.world_models.get(entity, ())
    bodies = [built.plant.get_body(index) for item in instances for index in built.plant.GetBodyIndices(item)]
    return [body for body in bodies if body.is_floating_base_body() and body.has_quaternion_dofs()]


def entity_state(built: TwinDiagram, plant_context: Context, entity: str, reference: str = WORLD) -> EntityState:
    """Return the pose and twist of an entity; see `Entities.state`."""
    body = find_body(built, entity)
    plant = built.plant
    frame = plant.world_frame() if reference == WORLD else find_body(built, reference).body_frame()
    X = body.body_frame().CalcPose(plant_context, frame)
    V = body.body_frame().CalcSpatialVelocity(plant_context, frame, frame)
    return EntityState(
        _three(X.translation()),
        tuple(map(float, X.rotation().ToQuaternion().wxyz())),  # type: ignore[arg-type]
        _three(V.translational()),
        _three(V.rotational()),
    )


def set_entity_state(
    built: TwinDiagram,
    plant_context: Context,
    entity: str,
    position: Iterable[float] | None = None,
    orientation: Iterable[float] | None = None,
    linear: Iterable[float] | None = None,
    angular: Iterable[float] | None = None,
    reference: str = WORLD,
) -> None:
    """Set the pose or velocity of a robot or a moving model; see `Entities.set_state`."""
    plant = built.plant
    body = find_body(built, entity)
    if not body.is_floating_base_body() or not body.has_quaternion_dofs():
        what = "is fixed to the world, or to another link, or moves on driven joints"
        raise InputError(f"Entity [{entity}] cannot be moved: it {what}")
    frame = plant.world_frame() if reference == WORLD else find_body(built, reference).body_frame()
    now = entity_state(built, plant_context, entity, reference)
    p = finite_numbers(position, 3, "position") if position is not None else np.array(now.position)
    q = finite_numbers(orientation, 4, "orientation") if orientation is not None else np.array(now.orientation)
    if not np.abs(q).max() > 0:
        raise InputError("the orientation is zero, which is not a rotation")
    v = finite_numbers(linear, 3, "linear velocity") if linear is not None else np.array(now.linear)
    w = finite_numbers(angular, 3, "angular velocity") if angular is not None else np.array(now.angular)
    X_WR = plant.CalcRelativeTransform(plant_context, plant.world_frame(), frame)
    X_WB = X_WR @ RigidTransform(_rotation(q), p)
    R = X_WR.rotation()
    V_WR, V_RB_W = frame.CalcSpatialVelocityInWorld(plant_context), SpatialVelocity(w=R @ w, v=R @ v)
    V_WB = V_WR.ComposeWithMovingFrameVelocity(R @ p, V_RB_W)
    X_change = X_WB @ body.EvalPoseInWorld(plant_context).inverse()
    others = [each for each in _free_bodies(built, entity) if each.index() != body.index()]
    for other in others:  # of a model with several trees of links all move, as in gz-physics (FreeGroupFeatures.cc)
        plant.SetFreeBodyPose(plant_context, other, X_change @ other.EvalPoseInWorld(plant_context))
    plant.SetFreeBodyPose(plant_context, body, X_WB)
    for each in (body, *(others if linear is not None or angular is not None else ())):
        plant.SetFreeBodySpatialVelocity(plant_context, each, V_WB)


def set_joint_positions(
    built: TwinDiagram, plant_context: Context, plan: RobotPlan, positions: Mapping[str, float]
) -> None:
    """Set joint positions of a robot; see `Entities.set_joint_positions`.

    Joints that mimic others and are not named follow: else their coupling would close the gap in one step.
    """
    if not isinstance(positions, Mapping):
        raise InputError(f"{positions!r} is not a mapping of joints to positions")
    parts = built.robots[plan.name]
    q = built.plant.GetPositions(plant_context, parts.instance)
    for joint, position in positions.items():
        if joint not in plan.joints.start_positions:
            text = f"robot {plan.name!r} has no movable joint {joint!r}"
            raise InputError(text, value=str(joint), valid=plan.joints.start_positions)
        if not is_number(position):
            raise InputError(f"position {position!r} of joint {joint!r} is not a finite number")
        q[parts.layout.positions[joint]] = position
    joints = plan.description.movable_joints
    now = {joint.name: q[parts.layout.positions[joint.name]] for joint in joints}
    for joint, position in plan.description.with_followers(now).items():
        if joint not in positions:
            q[parts.layout.positions[joint]] = position
    built.plant.SetPositions(plant_context, parts.instance, q)


def make_wrench(
    built: TwinDiagram,
    plant_context: Context,
    entity: str,
    force: Iterable[float],
    torque: Iterable[float],
    until: float,
    reference: str,
    at: Iterable[float],
) -> Wrench:
    """Return a wrench in the world's axes; see `Entities.apply_wrench`."""
    find_body(built, entity)
    R = RotationMatrix()
    if reference != WORLD:
        R = find_body(built, reference).body_frame().CalcPoseInWorld(plant_context).rotation()
    turned = [R @ finite_numbers(vector, 3, what) for vector, what in ((force, "force"), (torque, "torque"))]
    point = finite_numbers(at, 3, "point")
    return Wrench(str(entity), _three(turned[0]), _three(turned[1]), until, _three(point))


def _rotation(q: np.ndarray) -> RotationMatrix:
    from pydrake.common.eigen_geometry import Quaternion

    q = q / np.abs(q).max()  # first, because the squares of very large numbers overflow
    return RotationMatrix(Quaternion(q / np.linalg.norm(q)))


def finite_numbers(values: Iterable[float], count: int, what: str) -> np.ndarray:
    """Return a list of numbers as an array.

    Raises:
        InputError: If there are not ``count`` of them, or one is not finite; ``what`` names them.
    """
    try:
        numbers = np.array([float(value) for value in values])
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"the {what} {shortened(values)} is not a list of numbers") from None
    if numbers.shape != (count,) or not all(map(isfinite, numbers)):
        raise InputError(f"the {what} {shortened(values)} is not {count} finite numbers")
    return numbers


def _three(vector: Sequence[float] | np.ndarray) -> tuple[float, float, float]:
    x, y, z = map(float, vector)
    return x, y, z
