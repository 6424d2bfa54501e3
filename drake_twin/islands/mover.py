"""What moves as one: a robot, or a moving model of the world, with its places in the plant that holds all state."""

from collections.abc import Hashable, Iterator

import numpy as np
from pydrake.geometry import ProximityProperties, SceneGraphInspector
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex, QuaternionFloatingJoint, RigidBody
from pydrake.systems.framework import Context

from drake_twin.dataclass import dataclass
from drake_twin.diagram.twin_diagram import TwinDiagram


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
    found = [(plan.name, True, (built.robots[plan.name].instance,)) for plan in built.plans]
    found += [(name, False, instances) for name, instances in built.world_models.items()]
    tied = {int(body.model_instance()) for joint in built.detachable_joints for body in (joint.parent, joint.child)}
    context = plant.CreateDefaultContext()
    movers = []
    for name, is_robot, instances in found:
        places = places_of(plant, instances)
        if places.bodies:
            kind = name if tied.intersection(map(int, instances)) else _kind(plant, context, inspector, name, places)
            movers.append(Mover(name, is_robot, places, kind))
    return movers


def _kind(
    plant: MultibodyPlant, context: Context, inspector: SceneGraphInspector, name: str, places: Places
) -> Hashable:
    """Return all that the physics of a mover depends on; its name, if it is jointed to a place of the world."""
    bodies = [plant.get_body(index) for index in places.bodies]
    joints = [plant.get_joint(index) for instance in places.instances for index in plant.GetJointIndices(instance)]
    world = plant.world_body().index()
    if any(
        joint.parent_body().index() == world and joint.type_name() != QuaternionFloatingJoint.kTypeName
        for joint in joints
    ):
        return name
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
