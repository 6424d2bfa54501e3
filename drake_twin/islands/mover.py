"""What moves as one: a robot, or a moving model of the world, with its places in the plant that holds all state."""

from collections.abc import Hashable, Iterator

import numpy as np
from pydrake.geometry import ProximityProperties, SceneGraphInspector
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import BodyIndex, JointIndex, ModelInstanceIndex, QuaternionFloatingJoint, RigidBody
from pydrake.systems.framework import Context

from drake_twin.dataclass import dataclass
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.planning.robot_plan import RobotPlan


@dataclass(frozen=True, eq=False)
class Mover:
    """A robot, or a moving model of the world.

    Attributes:
        name: Its name.
        is_robot: Whether it is a robot.
        places: Its places in a plant.
        kind: Equal for movers that one plant can hold one instead of the other.
    """

    name: str
    is_robot: bool
    places: "Places"
    kind: Hashable


@dataclass(frozen=True, eq=False)
class Places:
    """The places of a mover in a plant.

    Attributes:
        instances: Its model instances.
        state: The indices of its ``[q; v]`` in the plant's, one model instance after the other.
        bodies: Its bodies.
        joints: The indices of its joints.
        actuators: The indices of its actuators' efforts in those of the plant.
    """

    instances: tuple[ModelInstanceIndex, ...]
    state: np.ndarray
    bodies: tuple[BodyIndex, ...]
    joints: tuple[int, ...]
    actuators: np.ndarray


def places_of(plant: MultibodyPlant, instances: tuple[ModelInstanceIndex, ...]) -> Places:
    """Return the places of a mover in a finalized plant."""
    nq, nv = plant.num_positions(), plant.num_velocities()
    state: list[int] = []
    for instance in instances:
        state += plant.GetPositionsFromArray(instance, np.arange(nq)).astype(int).tolist()
        state += (nq + plant.GetVelocitiesFromArray(instance, np.arange(nv)).astype(int)).tolist()
    actuators = [
        plant.get_joint_actuator(index).input_start()
        for instance in instances
        for index in plant.GetJointActuatorIndices(instance)
    ]
    return Places(
        instances,
        np.array(state, dtype=int),
        tuple(index for instance in instances for index in plant.GetBodyIndices(instance)),
        tuple(int(index) for instance in instances for index in plant.GetJointIndices(instance)),
        np.array(actuators, dtype=int),
    )


def movers_of(built: TwinDiagram, inspector: SceneGraphInspector) -> list[Mover]:
    """Return the robots, then the moving models of the world, each in the diagram's order."""
    plant = built.plant
    plans = {plan.name: plan for plan in built.plans}
    found = [(name, (built.robots[name].instance,)) for name in plans]
    found += list(built.world_models.items())
    tied = {int(body.model_instance()) for joint in built.detachable_joints for body in (joint.parent, joint.child)}
    context = plant.CreateDefaultContext()
    movers = []
    for name, instances in found:
        places, plan = places_of(plant, instances), plans.get(name)
        if not places.bodies:
            continue
        kind: Hashable = name
        if not tied.intersection(map(int, instances)) and _is_loose(plant, places, may_have_joints=plan is not None):
            kind = _numbers(plant, context, inspector, places), None if plan is None else _texts(plan)
        movers.append(Mover(name, plan is not None, places, kind))
    return movers


def _is_loose(plant: MultibodyPlant, places: Places, *, may_have_joints: bool) -> bool:
    """Tell whether nothing joints a mover to a place of the world, nor its own bodies if it may not have joints."""
    world = plant.world_body().index()
    joints = [plant.get_joint(JointIndex(index)) for index in places.joints]
    own = [joint for joint in joints if joint.type_name() != QuaternionFloatingJoint.kTypeName]
    return not own or (may_have_joints and all(joint.parent_body().index() != world for joint in own))


def _texts(plan: RobotPlan) -> Hashable:
    """Return what decides on a robot's physics beside its numbers: springs, mimic joints, friction, what touches."""
    robot = plan.robot
    texts = (plan.description.text.replace(plan.name, ""), plan.model.drake_text.replace(plan.name, ""))
    friction = robot.friction, tuple(sorted(robot.joint_friction.items()))
    return *texts, *friction, robot.contact, robot.collision, robot.self_collision


def _numbers(plant: MultibodyPlant, context: Context, inspector: SceneGraphInspector, places: Places) -> Hashable:
    """Return the masses, shapes, joints and motors of a mover."""
    bodies = [plant.get_body(index) for index in places.bodies]
    joints = [plant.get_joint(JointIndex(index)) for index in places.joints]
    numbers = {body.index(): number for number, body in enumerate(bodies)}
    parts: list[Hashable] = []
    for body in bodies:
        inertia = body.CalcSpatialInertiaInBodyFrame(context).CopyToFullMatrix6()
        parts.append((inertia.tobytes(), *_shapes(plant, inspector, body)))
    for joint in joints:
        frames = [
            (numbers.get(frame.body().index(), -1), frame.GetFixedPoseInBodyFrame().GetAsMatrix34().tobytes())
            for frame in (joint.frame_on_parent(), joint.frame_on_child())
        ]
        limits = [joint.position_lower_limits(), joint.position_upper_limits(), joint.default_damping_vector()]
        parts.append((joint.type_name(), *frames, *(values.tobytes() for values in limits)))
    for instance in places.instances:
        for motor in map(plant.get_joint_actuator, plant.GetJointActuatorIndices(instance)):
            numbers_of = motor.effort_limit(), motor.default_rotor_inertia(), motor.default_gear_ratio()
            parts.append((motor.joint().type_name(), *numbers_of))
        parts.append(plant.is_gravity_enabled(instance))
    return tuple(parts)


def _shapes(plant: MultibodyPlant, inspector: SceneGraphInspector, body: RigidBody) -> Iterator[Hashable]:
    for geometry in plant.GetCollisionGeometriesForBody(body):
        properties = inspector.GetProximityProperties(geometry)
        pose = inspector.GetPoseInFrame(geometry).GetAsMatrix34().tobytes()
        values = [
            (group, key, _plain(properties, group, key))
            for group in sorted(properties.GetGroupNames())
            for key in sorted(properties.GetPropertiesInGroup(group))
        ]
        yield repr(inspector.GetShape(geometry)), pose, *values


def _plain(properties: ProximityProperties, group: str, key: str) -> Hashable:
    try:
        value = properties.GetProperty(group, key)
    except RuntimeError:  # of a type that pydrake does not know
        return None
    if isinstance(value, CoulombFriction):
        return value.static_friction(), value.dynamic_friction()
    return value if isinstance(value, int | float | str) else str(type(value))
