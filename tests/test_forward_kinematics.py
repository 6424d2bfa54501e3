"""tf against Pinocchio, which reads the same URDF with code of its own."""

import numpy as np
import pinocchio
import pytest
from conftest import ARM, ROVER

from drake_twin import TwinBuilder


def transforms(message):
    """Child frame → (parent frame, 4x4 matrix)."""
    found = {}
    for item in message.transforms:
        translation, rotation = item.transform.translation, item.transform.rotation
        matrix = np.eye(4)
        quaternion = pinocchio.Quaternion(rotation.w, rotation.x, rotation.y, rotation.z)
        matrix[:3, :3] = quaternion.toRotationMatrix()
        matrix[:3, 3] = (translation.x, translation.y, translation.z)
        found[item.child_frame_id] = (item.header.frame_id, matrix)
    return found


def pose_in_world(frame, tree):
    pose = np.eye(4)
    while frame != "world":
        frame, matrix = tree[frame]
        pose = matrix @ pose
    return pose


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("model", [ROVER, ARM], ids=["rover", "arm"])
def test_tf_of_every_link_agrees_with_pinocchio(model, seed):
    twin = TwinBuilder().robot("robot_1", model, xyz=(0.3, -0.2, 0.5), rpy=(0.1, 0.2, 0.3)).build()
    (plan,) = twin._session.built.plans
    robot = twin._session.built.robots["robot_1"]
    layout = robot.layout
    rng = np.random.default_rng(seed)

    # Pinocchio: the arm is fixed at its root, the rover's root floats.
    floats = layout.base_position is not None
    text = plan.description.text
    root = [pinocchio.JointModelFreeFlyer()] if floats else []
    reference = pinocchio.buildModelFromXML(text, *root)
    q = pinocchio.neutral(reference)
    state = twin.plant.GetPositions(twin._session.physics.plant_context, robot.instance)
    for joint in plan.description.movable_joints:
        value = rng.uniform(-1.5, 1.5)
        state[layout.positions[joint.name]] = value
        index = reference.joints[reference.getJointId(joint.name)].idx_q
        if joint.type == "continuous":
            q[index : index + 2] = np.cos(value), np.sin(value)
        else:
            q[index] = value
    spawn = pinocchio.SE3.Identity()
    if floats:
        quaternion = rng.normal(size=4)
        quaternion /= np.linalg.norm(quaternion)
        position = rng.normal(size=3)
        state[layout.base_position :][:7] = [*quaternion, *position]
        w, x, y, z = quaternion
        q[:7] = [*position, x, y, z, w]
    else:
        spawn = pinocchio.SE3(pinocchio.rpy.rpyToMatrix(0.1, 0.2, 0.3), np.array([0.3, -0.2, 0.5]))
    twin.plant.SetPositions(twin.plant.GetMyMutableContextFromRoot(twin.context), robot.instance, state)
    data = reference.createData()
    pinocchio.framesForwardKinematics(reference, data, q)

    tree = transforms(twin.latest("/tf")) | transforms(twin.latest("/tf_static"))
    for link in plan.description.links:
        expected = (spawn * data.oMf[reference.getFrameId(link)]).homogeneous
        found = pose_in_world(plan.frame_prefix + link, tree)
        assert np.abs(found - expected).max() < 1e-9, link
