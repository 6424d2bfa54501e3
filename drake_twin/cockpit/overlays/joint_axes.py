"""The axes of joints, the range of each between its limits, and where in it the joint is."""

from math import isfinite, pi, tau
from typing import Any

import numpy as np
from pydrake.geometry import Cylinder, MeshcatCone, Rgba
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.tree import PrismaticJoint, RevoluteJoint

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.overlays.body_folders import BodyFolders
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.twin.twin import Twin

_SIZES = (0.02, 0.2)  # m: the smallest and the largest axis
_PART = 0.5  # of the usual distance between two joints
_ARC = 64  # segments of a full turn
_WIDENING = 0.12  # of the radius, with each turn of a range of more than one
_UNLIMITED = 1.0  # m of a prismatic joint's range that is drawn where it has no limit
_AXIS, _RANGE, _NEEDLE = Rgba(0.85, 0.41, 0.04), (0.15, 0.42, 0.75), (0.80, 0.16, 0.16)


@overlay(
    "joints",
    "Joint axes and limits",
    "The axis of each joint; of the selected robot also the range between the limits, with a needle at the position",
    "J",
)
class JointAxes:
    """An arrow along the axis of each movable joint.

    The range is fixed to the parent link and the needle to the child link, so that nothing is sent while they move.
    """

    def __init__(self, scene: Scene, twin: Twin):
        self._folders = BodyFolders(scene, twin, f"{OVERLAYS}/joints")
        self._scene = scene
        for plan in twin.built.plans:
            instance = twin.built.robots[plan.name].instance
            names = [joint.name for joint in plan.description.movable_joints]
            joints = [twin.plant.GetJointByName(name, instance) for name in names if _has(twin, name, instance)]
            size = _size(joints)
            for joint in joints:
                self._add(joint, size)

    def draw(self) -> None:
        """Move what no browser moves."""
        self._folders.draw()

    def remove(self) -> None:
        """Remove everything."""
        self._folders.remove()

    def _add(self, joint: Any, size: float) -> None:
        scene, number = self._scene, int(joint.index())
        axis, ends, needle = joint_range(joint, size)
        parent, X_FP = self._folders.of(joint.parent_body().index())
        child, X_GC = self._folders.of(joint.child_body().index())
        X_FJ = X_FP @ joint.frame_on_parent().GetFixedPoseInBodyFrame()
        X_GJ = X_GC @ joint.frame_on_child().GetFixedPoseInBodyFrame()
        arrow = f"{parent}/{number}"
        scene.set_object(f"{arrow}/shaft", Cylinder(0.03 * size, 1.6 * size), _AXIS, on_top=True)
        scene.set_object(f"{arrow}/head", MeshcatCone(0.25 * size, 0.1 * size, 0.1 * size), _AXIS, on_top=True)
        # Drake's cones stand on their tip.
        scene.set_transform(f"{arrow}/head", RigidTransform(RotationMatrix.MakeXRotation(pi), [0, 0, 1.05 * size]))
        scene.set_transform(arrow, X_FJ @ RigidTransform(RotationMatrix.MakeFromOneVector(axis, 2), np.zeros(3)))
        scene.set_lines(f"{parent}/limits/{number}", ends, _RANGE, on_top=True)
        scene.set_transform(f"{parent}/limits/{number}", X_FJ)
        scene.set_lines(f"{child}/limits/{number}needle", needle, _NEEDLE, on_top=True)
        scene.set_transform(f"{child}/limits/{number}needle", X_GJ)


def joint_range(joint: Any, size: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the axis of a joint, and lines of its range and its needle.

    Args:
        joint: A revolute or prismatic joint of a plant.
        size: The radius of an arc (m).

    Returns:
        The axis, shape (3,), and the ends of the range's segments, shape (2 n, 3), in the joint's frame on the parent;
        the ends of the needle, shape (2 m, 3), in that on the child (m).
    """
    lower, upper = float(joint.position_lower_limits()[0]), float(joint.position_upper_limits()[0])
    if isinstance(joint, PrismaticJoint):
        axis = np.asarray(joint.translation_axis())
        away = _across(axis)
        lower, upper = max(lower, -_UNLIMITED), min(upper, _UNLIMITED)
        stops = [(at * axis - 0.3 * size * away, at * axis + 0.3 * size * away) for at in (lower, upper)]
        needle = [(-0.5 * size * away, 0.5 * size * away)]
        return axis, np.reshape([(lower * axis, upper * axis), *stops], (-1, 3)), np.reshape(needle, (-1, 3))
    axis = np.asarray(joint.revolute_axis())
    away = _across(axis)
    is_limited = isfinite(lower) and isfinite(upper)
    lower, upper = (lower, upper) if is_limited else (-pi, pi)
    beside = np.cross(axis, away)
    turns = (upper - lower) / tau
    angles = np.linspace(lower, upper, max(2, round(_ARC * turns) + 1))
    widening = 1.0 + (_WIDENING * (angles - lower) / tau if turns > 1.0 else 0.0 * angles)
    arc = size * widening[:, None] * (np.cos(angles)[:, None] * away + np.sin(angles)[:, None] * beside)
    segments = np.stack([arc[:-1], arc[1:]], axis=1).reshape(-1, 3)
    if is_limited:
        segments = np.vstack([segments, 0.6 * arc[0], 1.15 * arc[0], 0.6 * arc[-1], 1.15 * arc[-1]])
    return axis, segments, np.array([np.zeros(3), 1.1 * size * away])


def _across(axis: np.ndarray) -> np.ndarray:
    """Return a direction across an axis; a joint at zero points there."""
    return np.asarray(RotationMatrix.MakeFromOneVector(axis, 2).matrix()[:, 0])


def _has(twin: Twin, name: str, instance: Any) -> bool:
    """Return whether the plant has a joint with one axis by that name."""
    if not twin.plant.HasJointNamed(name, instance):
        return False
    return isinstance(twin.plant.GetJointByName(name, instance), RevoluteJoint | PrismaticJoint)


def _size(joints: list[Any]) -> float:
    """Return the length of the axes of a robot (m): they are smaller where its joints are closer."""
    offsets = [joint.frame_on_parent().GetFixedPoseInBodyFrame().translation() for joint in joints]
    usual = float(np.median([length for each in offsets if (length := np.linalg.norm(each)) > 1e-3] or _SIZES[1:]))
    return min(max(_PART * usual, _SIZES[0]), _SIZES[1])
