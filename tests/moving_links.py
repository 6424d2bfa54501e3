"""Forces on the links of the hand of `device_harness` while it moves through the air, without a simulation."""

import numpy as np
from device_harness import ROBOT
from pydrake.math import RollPitchYaw
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import PrismaticJoint, RevoluteJoint, SpatialInertia

from drake_twin.controllers.body_forces import Motion, RobotBody


def plant_of_hand():
    """A plant with the hand alone."""
    plant = MultibodyPlant(0.01)
    inertia = SpatialInertia.SolidBoxWithMass(1.0, 0.1, 0.1, 0.1)
    palm, *fingers = (plant.AddRigidBody(name, inertia) for name in ROBOT.links)
    for joint, link in zip(ROBOT.joints, fingers, strict=True):
        kind = PrismaticJoint if joint.type == "prismatic" else RevoluteJoint
        plant.AddJoint(kind(joint.name, palm.body_frame(), link.body_frame(), [1.0, 0.0, 0.0]))
    plant.Finalize()
    return plant


def rotation(rpy):
    return RollPitchYaw(*rpy).ToRotationMatrix().matrix()


def wrenches_of(
    kind, plant, controllers, linear, angular=(0.0, 0.0, 0.0), rpy=(0.0, 0.0, 0.0), wind=(0.0, 0.0, 0.0), active=1.0
):
    """Of each controller on the palm, in its axes: moment, force; the velocities are in the world's."""
    body = RobotBody(plant, plant.GetBodyByName("palm").model_instance())
    forces, count = kind([(item, body) for item in controllers]), len(controllers)
    R = rotation(rpy)
    V_B = np.concatenate([R.T @ angular, R.T @ linear])
    places = np.zeros(count, dtype=int)
    blowing = np.array(wind) if any(wind) else None
    motion = Motion(0.0, _state(plant), R[None, :, :], np.zeros((1, 3)), V_B[None, :], places, wind=blowing)
    return forces.wrenches(motion, np.full(count, active))


def position_of(plant, joint):
    """Where a joint is meanwhile (m or rad)."""
    return float(_state(plant)[plant.GetJointByName(joint).position_start()])


def _state(plant):
    return np.linspace(0.1, 0.9, plant.num_multibody_states())
