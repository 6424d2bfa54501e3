"""A base that is moved over the plane by driven joints between the world and the root link.

Gazebo's plugins set the velocity of the whole robot. Here the root link is on three slides along the axes of its spawn
pose, projected onto the ground plane, and a rotation about z. The slides x and y and the rotation have velocity servos
in the plant. The slide along z is free, so that the robot rests on the ground; roll and pitch keep their start values,
as the plugins set their rates to zero. All joints are at zero at the start.

Feet that rub with a friction of 1 slow the base by 8e-5 m/s, at any velocity, in Drake's contact approximation
``lagged``. In ``similar`` and ``sap`` a driven body that rubs hops, and loses up to a tenth of its velocity.
"""

import numpy as np
from pydrake.geometry import SceneGraph
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    FixedOffsetFrame,
    ModelInstanceIndex,
    PrismaticJoint,
    RevoluteJoint,
    RigidBody,
    SpatialInertia,
)

from drake_twin.description.planar_joints import ANGULAR_Z, LINEAR_X, LINEAR_Y, LINEAR_Z
from drake_twin.description.robot_description import Pose
from drake_twin.diagram.joint_friction import is_brake
from drake_twin.kinematics.planar_base import PlanarBase

_SLIDES = {LINEAR_X: (1, 0, 0), LINEAR_Y: (0, 1, 0), LINEAR_Z: (0, 0, 1)}
_TURN = (0, 0, 1)

_LEAST_MASS = 1e-6  # kg

# The drive's largest force relative to the robot's mass (N/kg): three times its weight on Earth. The combined friction
# of two surfaces, one of which has at most 1, is less than 2, so this moves even a base that slides, and accelerates it
# at 1 g besides. With much more, a robot would push itself into walls.
_PUSH = 30.0


def add_planar_joints(plant: MultibodyPlant, root: RigidBody, spawn_pose: Pose) -> None:
    """Put a robot on the joints.

    Args:
        plant: The plant, not yet finalized.
        root: The robot's root link.
        spawn_pose: The pose of the root link in the world with all joints at zero.
    """
    instance = root.model_instance()
    roll, pitch, yaw = spawn_pose.rpy
    start = RigidTransform(RollPitchYaw(0.0, 0.0, yaw), np.array(spawn_pose.xyz))
    frame = plant.AddFrame(FixedOffsetFrame("base.start", plant.world_frame(), start, instance))
    # CENIC divides by the mass that a joint moves, without the bodies behind further joints.
    inertia = SpatialInertia.Zero() if plant.time_step() else SpatialInertia.SolidSphereWithMass(_LEAST_MASS, 0.01)
    for name, axis in _SLIDES.items():
        carriage = plant.AddRigidBody(name, instance, inertia).body_frame()
        plant.AddJoint(PrismaticJoint(name, frame, carriage, axis))
        frame = carriage
    untilted = RigidTransform(RollPitchYaw(roll, pitch, 0.0), np.zeros(3)).inverse()
    upright = plant.AddFrame(FixedOffsetFrame("base.upright", root.body_frame(), untilted, instance))
    plant.AddJoint(RevoluteJoint(ANGULAR_Z, frame, upright, _TURN))


def limit_planar_efforts(
    plant: MultibodyPlant, scene_graph: SceneGraph, instance: ModelInstanceIndex, grip: float | None
) -> None:
    """Limit the drive's force and torque, which follow from the robot's mass.

    Args:
        plant: The finalized plant.
        scene_graph: The scene graph with the robot's collision shapes.
        instance: The robot's model instance.
        grip: The largest force relative to the robot's weight; None for a drive that moves even a base that rubs.
    """
    context = plant.CreateDefaultContext()
    mass = plant.CalcTotalMass(context, [instance])
    gravity = float(np.linalg.norm(plant.gravity_field().gravity_vector()))
    force = (_PUSH if grip is None else grip * gravity) * mass
    turn = plant.GetJointByName(ANGULAR_Z, instance)
    inertia = plant.CalcMassMatrix(context)[turn.velocity_start(), turn.velocity_start()]
    lever = max(float(np.sqrt(inertia / mass)), _farthest_shape(plant, scene_graph, instance))
    for name, limit in ((LINEAR_X, force), (LINEAR_Y, force), (ANGULAR_Z, force * lever)):
        plant.GetJointActuatorByName(name, instance).set_effort_limit(limit)


def _farthest_shape(plant: MultibodyPlant, scene_graph: SceneGraph, instance: ModelInstanceIndex) -> float:
    """Return the distance of the farthest collision shape's center from the rotation's axis (m)."""
    context = plant.CreateDefaultContext()
    inspector = scene_graph.model_inspector()
    axis = plant.GetFrameByName("base.upright", instance).CalcPoseInWorld(context).translation()
    centers = [axis]
    for body in map(plant.get_body, plant.GetBodyIndices(instance)):
        pose = plant.EvalBodyPoseInWorld(context, body)
        shapes = [shape for shape in plant.GetCollisionGeometriesForBody(body) if not is_brake(inspector, shape)]
        centers += [(pose @ inspector.GetPoseInFrame(shape)).translation() for shape in shapes]
    return float(max(np.linalg.norm(center[:2] - axis[:2]) for center in centers))


def planar_base(plant: MultibodyPlant, instance: ModelInstanceIndex, spawn_pose: Pose) -> PlanarBase:
    """Return the indices of the joints in the robot's state.

    Args:
        plant: The finalized plant.
        instance: The robot's model instance.
        spawn_pose: The pose of the root link in the world with all joints at zero.
    """
    num_positions = plant.num_positions(instance)
    positions = plant.GetPositionsFromArray(instance, np.arange(plant.num_positions())).astype(int).tolist()
    velocities = plant.GetVelocitiesFromArray(instance, np.arange(plant.num_velocities())).astype(int).tolist()
    joints = [plant.GetJointByName(name, instance) for name in (*_SLIDES, ANGULAR_Z)]
    return PlanarBase(
        spawn_pose,
        tuple(positions.index(joint.position_start()) for joint in joints),
        tuple(num_positions + velocities.index(joint.velocity_start()) for joint in joints),
    )
