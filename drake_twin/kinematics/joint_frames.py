"""The poses of joints' child links: many joints at once, with trigonometry only for the joint angles."""

from collections.abc import Sequence

import numpy as np

from drake_twin.description.robot_description import Joint
from drake_twin.kinematics.rotations import quaternion_from_rpy, quaternion_product, rotated


class JointFrames:
    """Calculate the pose of each joint's child link in its parent link from joint positions.

    Both parts of a pose are linear in few functions of the position ``q``, so that their coefficients are computed
    once: the quaternion in ``cos(q/2)`` and ``sin(q/2)``, the translation in ``q`` for a sliding joint, and in
    ``cos(q)`` and ``sin(q)`` if the child link is beside the axis of rotation, as in some SDF files.

    Args:
        joints: Revolute, continuous and prismatic joints, and fixed ones, whose positions are 0.

    Attributes:
        moves_along: Whether each joint's position changes the translation, shape (n,).
    """

    def __init__(self, joints: Sequence[Joint]):
        turns = np.array([joint.type != "prismatic" for joint in joints], dtype=bool)
        axes = np.array([joint.axis for joint in joints]).reshape(-1, 3)
        origin = quaternion_from_rpy(np.array([joint.origin.rpy for joint in joints]).reshape(-1, 3))
        child = quaternion_from_rpy(np.array([joint.child_origin.rpy for joint in joints]).reshape(-1, 3))
        child_xyz = np.array([joint.child_origin.xyz for joint in joints]).reshape(-1, 3)
        self._half = 0.5 * turns
        self._by_cos_half = quaternion_product(origin, child)
        about_axis = np.hstack([np.zeros((len(joints), 1)), axes])
        self._by_sin_half = quaternion_product(quaternion_product(origin, about_axis), child)
        # The rotation of a point about an axis: the component along it stays, the rest rotates in the plane across it
        # (Rodrigues).
        along = axes * (axes * child_xyz).sum(axis=1, keepdims=True)
        along[~turns] = child_xyz[~turns]
        self._constant = np.array([joint.origin.xyz for joint in joints]).reshape(-1, 3) + rotated(origin, along)
        self._by_position = rotated(origin, axes * ~turns[:, None])
        self._by_cos = rotated(origin, child_xyz - along)
        self._by_sin = rotated(origin, np.cross(axes, child_xyz - along))
        self._is_beside = bool(self._by_cos.any())
        self.moves_along = (np.abs(self._by_position) + np.abs(self._by_cos)).sum(axis=1) > 0.0

    def quaternions(self, positions: np.ndarray) -> np.ndarray:
        """Return rotations (w, x, y, z), shape (n, 4), for positions (rad or m), shape (n,)."""
        half = positions * self._half
        return np.asarray(np.cos(half)[:, None] * self._by_cos_half + np.sin(half)[:, None] * self._by_sin_half)

    def xyz(self, positions: np.ndarray) -> np.ndarray:
        """Return translations (m), shape (n, 3), for positions (rad or m), shape (n,)."""
        xyz = self._constant + positions[:, None] * self._by_position
        if self._is_beside:
            xyz += np.cos(positions)[:, None] * self._by_cos + np.sin(positions)[:, None] * self._by_sin
        return np.asarray(xyz)
