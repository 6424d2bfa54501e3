"""Where joints place their child links: many joints at once, without trigonometry but for the joint angles."""

from collections.abc import Sequence

import numpy as np

from drake_twin.description.robot_description import Joint
from drake_twin.systems.rotations import quaternion_from_rpy, quaternion_product, rotated


class JointFrames:
    """The pose of each joint's child link in its parent link, for joint positions.

    Both parts of a pose are linear in few functions of the position ``q``, so that their coefficients are computed
    once: the quaternion in ``cos(q/2)`` and ``sin(q/2)``, the translation in ``q`` for what slides, and in ``cos(q)``
    and ``sin(q)`` where the child link lies beside the axis that it turns about, as in some SDF files.

    Args:
        joints: Revolute, continuous and prismatic ones, or fixed ones, whose positions are 0.

    Attributes:
        moves_along: Shape (n,): whether the joint's position changes the translation.
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
        # A point turned about an axis: what lies along it stays, the rest turns in the plane across it (Rodrigues).
        along = axes * (axes * child_xyz).sum(axis=1, keepdims=True)
        along[~turns] = child_xyz[~turns]
        self._constant = np.array([joint.origin.xyz for joint in joints]).reshape(-1, 3) + rotated(origin, along)
        self._by_position = rotated(origin, axes * ~turns[:, None])
        self._by_cos = rotated(origin, child_xyz - along)
        self._by_sin = rotated(origin, np.cross(axes, child_xyz - along))
        self._is_beside = bool(self._by_cos.any())
        self.moves_along = (np.abs(self._by_position) + np.abs(self._by_cos)).sum(axis=1) > 0.0

    def quaternions(self, positions: np.ndarray) -> np.ndarray:
        """Rotations (w, x, y, z), shape (n, 4), for positions (rad or m), shape (n,)."""
        half = positions * self._half
        return np.asarray(np.cos(half)[:, None] * self._by_cos_half + np.sin(half)[:, None] * self._by_sin_half)

    def xyz(self, positions: np.ndarray) -> np.ndarray:
        """Translations (m), shape (n, 3), for positions (rad or m), shape (n,)."""
        xyz = self._constant + positions[:, None] * self._by_position
        if self._is_beside:
            xyz += np.cos(positions)[:, None] * self._by_cos + np.sin(positions)[:, None] * self._by_sin
        return np.asarray(xyz)
