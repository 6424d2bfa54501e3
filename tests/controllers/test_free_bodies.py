"""The motion of free bodies from the plant's state, beside the plant's own."""

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RevoluteJoint, SpatialInertia

from drake_twin.controllers.free_bodies import FreeBodies


def test_poses_and_velocities_are_those_of_the_plant_whatever_the_length_of_a_quaternion():
    plant, inertia = MultibodyPlant(0.001), SpatialInertia.SolidBoxWithDensity(500, 0.3, 0.2, 0.1)
    bodies = [plant.AddRigidBody(f"body_{number}", inertia) for number in range(6)]
    hinge = RevoluteJoint("hinge", bodies[0].body_frame(), bodies[1].body_frame(), [0, 0, 1])
    plant.AddJoint(hinge)
    plant.AddJoint(RevoluteJoint("post", plant.world_frame(), bodies[2].body_frame(), [0, 1, 0]))
    plant.Finalize()
    free = [body for body in bodies if FreeBodies.has(body)]
    assert [body.name() for body in free] == ["body_0", "body_3", "body_4", "body_5"]
    random, context = np.random.default_rng(1), plant.CreateDefaultContext()
    reader = FreeBodies(free, plant.num_positions())
    for _ in range(20):
        state = random.normal(size=plant.num_multibody_states())
        plant.SetPositionsAndVelocities(context, state)
        for body, R_WB, origin, velocity in zip(free, *reader.read(state), strict=True):
            X_WB = body.EvalPoseInWorld(context)
            assert np.abs(R_WB - X_WB.rotation().matrix()).max() < 1e-14
            assert origin.tolist() == X_WB.translation().tolist()
            assert np.abs(velocity - body.EvalSpatialVelocityInWorld(context).get_coeffs()).max() < 1e-14
