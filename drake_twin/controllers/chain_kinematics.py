"""The differential kinematics of a chain of joints, as ROS's kinematics_interface offers them."""

from collections.abc import Sequence

import numpy as np
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    FixedOffsetFrame,
    JacobianWrtVariable,
    PrismaticJoint,
    RevoluteJoint,
    RigidBody,
    SpatialInertia,
    WeldJoint,
)
from pydrake.systems.framework import Context

from drake_twin.description.robot_description import Joint, Pose, RobotDescription


class ChainKinematics:
    """Calculate poses and Jacobians of links relative to a base link, in a plant of the robot's links and joints alone.

    Joints that are not among ``joints`` stay at zero: `joints_between` says which ones move a link.

    Args:
        description: The robot.
        base: The link that everything is relative to.
        joints: The revolute, continuous or prismatic joints whose positions are given, in the order of the vectors.
        alpha: The damping of the Jacobian's inverse, as of ``kinematics_interface_kdl``.
    """

    def __init__(self, description: RobotDescription, base: str, joints: Sequence[str], alpha: float):
        plant = MultibodyPlant(0.0)
        self._bodies = {link: plant.AddRigidBody(link, SpatialInertia.NaN()) for link in description.links}
        root = self._bodies[description.root_link].body_frame()
        plant.WeldFrames(plant.world_frame(), root)
        for joint in description.joints:
            _add_joint(plant, joint, self._bodies[joint.parent], self._bodies[joint.child])
        plant.Finalize()
        found = [plant.GetJointByName(name) for name in joints]
        self._positions = [joint.position_start() for joint in found]
        self._velocities = [joint.velocity_start() for joint in found]
        self._plant, self._context = plant, plant.CreateDefaultContext()
        self._base = self._bodies[base].body_frame()
        self._damping = alpha * np.identity(len(joints))

    def pose(self, positions: np.ndarray, link: str) -> RigidTransform:
        """Return a link's pose in the base's frame at joint positions (rad or m)."""
        return self._plant.CalcRelativeTransform(self._at(positions), self._base, self._bodies[link].body_frame())

    def jacobian(self, positions: np.ndarray, link: str) -> np.ndarray:
        """Return the derivative of a link's twist, linear first, by the joints' velocities, shape (6, n)."""
        frame = self._bodies[link].body_frame()
        jacobian = self._plant.CalcJacobianSpatialVelocity(
            self._at(positions), JacobianWrtVariable.kV, frame, np.zeros(3), self._base, self._base
        )[:, self._velocities]
        return np.vstack([jacobian[3:], jacobian[:3]])

    def joint_deltas(self, positions: np.ndarray, deltas: np.ndarray, link: str) -> np.ndarray:
        """Return the joints' deltas, shape (n,), for a link's linear and angular deltas, by the damped inverse."""
        jacobian = self.jacobian(positions, link)
        return np.asarray(np.linalg.solve(jacobian.T @ jacobian + self._damping, jacobian.T @ deltas))

    def cartesian_deltas(self, positions: np.ndarray, deltas: np.ndarray, link: str) -> np.ndarray:
        """Return a link's linear and angular deltas, shape (6,), for the joints' deltas."""
        return np.asarray(self.jacobian(positions, link) @ deltas)

    def _at(self, positions: np.ndarray) -> Context:
        q = np.zeros(self._plant.num_positions())
        q[self._positions] = positions
        self._plant.SetPositions(self._context, q)
        return self._context


def joints_between(description: RobotDescription, base: str, link: str) -> frozenset[str]:
    """Return the joints, except fixed ones, whose motion moves a link relative to a base link."""
    by_child = {joint.child: joint for joint in description.joints}

    def above(name: str) -> set[str]:
        joints: set[str] = set()
        while name in by_child:
            joint = by_child[name]
            if joint.type != "fixed":
                joints.add(joint.name)
            name = joint.parent
        return joints

    return frozenset(above(base) ^ above(link))


def _add_joint(plant: MultibodyPlant, joint: Joint, parent: RigidBody, child: RigidBody) -> None:
    """Add a joint; one without exactly one position is a weld."""
    before, after = (
        plant.AddFrame(FixedOffsetFrame(f"{joint.name} in its {place}", body.body_frame(), pose))
        for place, body, pose in (
            ("parent", parent, _transform(joint.origin)),
            ("child", child, _transform(joint.child_origin).inverse()),
        )
    )
    if not joint.is_movable:
        plant.AddJoint(WeldJoint(joint.name, before, after, RigidTransform()))
    elif joint.type == "prismatic":
        plant.AddJoint(PrismaticJoint(joint.name, before, after, joint.axis))
    else:
        plant.AddJoint(RevoluteJoint(joint.name, before, after, joint.axis))


def _transform(pose: Pose) -> RigidTransform:
    return RigidTransform(RollPitchYaw(*pose.rpy), np.array(pose.xyz))
