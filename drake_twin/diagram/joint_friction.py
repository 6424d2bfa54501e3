"""Dry friction in joints, which Drake does not have, modeled in another way in each engine.

In the discrete engine an actuator brakes towards zero velocity with at most the friction. Drake's CENIC adds up the
actuators of a joint and limits their sum by one effort limit. So in a continuous plant a contact brakes the joint: a
shoe on the child link is pressed onto a plate on the parent link with a constant force. Only its torque about the
joint's axis, or its force along it, has an effect: the link is pushed as much as its parent is pushed back, at the same
point.
"""

from collections.abc import Iterable
from math import fsum, sqrt

from pydrake.geometry import (
    AddContactMaterial,
    Box,
    CollisionFilterDeclaration,
    GeometryId,
    GeometrySet,
    ProximityProperties,
    SceneGraph,
    SceneGraphInspector,
    Sphere,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import Frame, Joint, PrismaticJoint, RevoluteJoint, RigidBody

from drake_twin.dataclass import dataclass
from drake_twin.scenario import LONGEST_STEP

FRICTION_SUFFIX = "/friction"  # prefix of an actuator's name
_ENDINGS = ("/friction/shoe", "/friction/plate")  # prefix of the names of a brake's geometries

# A joint that the friction should hold creeps at this velocity under the full friction (rad/s or m/s).
CREEP = 1e-3

_RADIUS = 0.01  # of the shoe (m)
_DEPTH = 0.005  # depth of the shoe in the plate (m)
_MARGIN = 0.5  # extra length of a slide's plate beyond its range (m)
_LONGEST_SLIDE = 100.0  # length of the plate of a slide without limits, to either side (m)

# CENIC lets a contact slip at this ratio to the velocity that its friction gives the bodies' masses in a step
# (multibody/contact_solvers/icf/patch_constraints_pool.cc). A long lever makes a small force of the friction, so that a
# hinge does not creep faster than it should in the longest step.
_SLIP = 2.65e-3
_LEAST_LEVER = 0.02  # with which the plant's stiction tolerance is half of that creep (m)


@dataclass(frozen=True)
class Brake:
    """The two geometries of a brake; they touch each other and nothing else."""

    shoe: GeometryId
    plate: GeometryId


def can_have_brake(joint: Joint) -> bool:
    """Return whether a joint rotates about an axis or slides along one."""
    return isinstance(joint, RevoluteJoint | PrismaticJoint)


def add_brake(plant: MultibodyPlant, joint: Joint, friction: float) -> Brake:
    """Brake a joint of a continuous plant.

    Args:
        plant: The plant, not yet finalized, with the contact of all other shapes decided.
        joint: A joint that rotates about an axis or slides along one.
        friction: The friction (N·m or N).
    """
    if isinstance(joint, RevoluteJoint):
        lever = _lever(joint, friction)
        force, reach = friction / lever, lever
        X_J = RigidTransform(RotationMatrix.MakeFromOneVector(joint.revolute_axis(), 2))
    else:
        lever, force = 0.0, friction
        lower, upper = joint.position_lower_limit(), joint.position_upper_limit()
        reach = min(max(abs(lower), abs(upper)) + _MARGIN, _LONGEST_SLIDE)
        X_J = RigidTransform(RotationMatrix.MakeFromOneVector(joint.translation_axis(), 0))
    # The plate's face is z = 0 of J, a frame at the joint. The joint moves the shoe within that face.
    X_shoe = X_J @ RigidTransform([lever, 0.0, _RADIUS - _DEPTH])
    X_plate = X_J @ RigidTransform([0.0, 0.0, -_RADIUS])
    side = 2 * (reach + _RADIUS)
    properties = ProximityProperties()
    # Two equal stiffnesses in series are half as stiff; two equal frictions combine to the same.
    AddContactMaterial(0.0, 2 * force / _DEPTH, CoulombFriction(1.0, 1.0), properties)
    child, parent = joint.frame_on_child(), joint.frame_on_parent()
    return Brake(
        _add_shape(plant, child, X_shoe, Sphere(_RADIUS), f"{joint.name()}{_ENDINGS[0]}", properties),
        _add_shape(plant, parent, X_plate, Box(side, side, 2 * _RADIUS), f"{joint.name()}{_ENDINGS[1]}", properties),
    )


def isolate_brakes(scene_graph: SceneGraph, brakes: Iterable[Brake]) -> None:
    """Let the two halves of each brake touch only each other, once the plant is finalized and has its own filters."""
    brakes = list(brakes)
    if not brakes:
        return
    manager = scene_graph.collision_filter_manager()
    parts = GeometrySet([part for brake in brakes for part in (brake.shoe, brake.plate)])
    everything = GeometrySet(list(scene_graph.model_inspector().GetAllGeometryIds()))
    manager.Apply(CollisionFilterDeclaration().ExcludeBetween(parts, everything))
    for brake in brakes:
        manager.Apply(CollisionFilterDeclaration().AllowBetween(GeometrySet(brake.shoe), GeometrySet(brake.plate)))


def is_brake(inspector: SceneGraphInspector, geometry: GeometryId) -> bool:
    """Return whether a geometry belongs to a brake, and is not to be shown."""
    return str(inspector.GetName(geometry)).endswith(_ENDINGS)


def _lever(joint: Joint, friction: float) -> float:
    """Return the distance of the shoe from the axis at which the brake creeps as slowly as it should (m)."""
    masses = [body.default_mass() for body in (joint.child_body(), joint.parent_body())]
    mobility = fsum(1 / mass for mass in masses if mass > 0)
    return max(_LEAST_LEVER, sqrt(_SLIP * friction * LONGEST_STEP * mobility / CREEP))


def _add_shape(
    plant: MultibodyPlant,
    frame: Frame,
    pose: RigidTransform,
    shape: Sphere | Box,
    name: str,
    properties: ProximityProperties,
) -> GeometryId:
    body: RigidBody = frame.body()
    X_BF = frame.GetFixedPoseInBodyFrame()
    geometry: GeometryId = plant.RegisterCollisionGeometry(body, X_BF @ pose, shape, name, properties)
    return geometry
