"""Wheels: cylinders or round meshes that rotate about their own axis.

A cylinder that lies on a plane touches in one point at one end of its line, and rounding decides which end: a base that
turns in place is up to 13 % too slow. An ellipsoid of the same radius and width touches in its middle. It is thinner
than its cylinder near the rim.
"""

from collections.abc import Mapping
from math import cos, isfinite, pi, radians

import numpy as np
from pydrake.geometry import Convex, Cylinder, Ellipsoid, Shape
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Joint, JointIndex, ModelInstanceIndex, RevoluteJoint, RigidBody, WeldJoint

from drake_twin.description.hull import corners_of

_PARALLEL = cos(radians(1.0))  # angle between the joint's axis and the cylinder's
_OFF_CENTER = 0.02  # relative to the radius
_UPRIGHT = cos(radians(45.0))  # a body that rotates about a steeper axis than this is a turntable
_TURNS = 2.0  # a joint that can make more turns than this counts as unlimited
_WIDEST = 2.0  # width ÷ diameter
_WIDEST_MESH = 1.0
_ROUND_MESH = 0.96  # smallest ÷ largest radius of a mesh's outline


class WheelFinder:
    """Find wheels in a plant that is not finalized.

    Args:
        plant: The plant.
        root_poses: Model instance → the pose of its root body in the world at the start, if it is not the plant's
            default.
    """

    def __init__(self, plant: MultibodyPlant, root_poses: Mapping[ModelInstanceIndex, RigidTransform]):
        self._plant = plant
        self._root_poses = root_poses
        joints = [plant.get_joint(JointIndex(index)) for index in range(plant.num_joints())]
        self._inboard: dict[int, Joint] = {int(joint.child_body().index()): joint for joint in joints}

    def wheel(self, body: RigidBody, shape: Shape, X_BG: RigidTransform) -> tuple[Ellipsoid, RigidTransform] | None:
        """Return the ellipsoid of a wheel's shape, and its pose on the body; None for a shape that is not a wheel's."""
        if not isinstance(shape, Cylinder | Convex):
            return None
        turned = self._turned_about(body)
        if turned is None:
            return None
        joint, X_JB = turned  # J is the joint's frame M on its child
        axis = joint.revolute_axis()
        X_JG = X_JB @ X_BG
        found = _outline(shape, X_JG, axis)
        if found is None or abs(self._upwards(joint)) > _UPRIGHT:
            return None
        radius, width, along = found
        X_JE = RigidTransform(RotationMatrix.MakeFromOneVector(axis, 2), along * axis)
        return Ellipsoid(radius, radius, width / 2), X_JB.inverse() @ X_JE

    def _turned_about(self, body: RigidBody) -> tuple[RevoluteJoint, RigidTransform] | None:
        """Return the unlimited joint that rotates a body, also through welds, and the body's pose in it."""
        X = RigidTransform()
        seen = set()
        while (joint := self._inboard.get(int(body.index()))) is not None and body.index() not in seen:
            seen.add(body.index())
            X_MB = joint.frame_on_child().GetFixedPoseInBodyFrame().inverse()
            if isinstance(joint, WeldJoint):
                X = joint.frame_on_parent().GetFixedPoseInBodyFrame() @ joint.X_FM() @ X_MB @ X
                body = joint.parent_body()
                continue
            if not isinstance(joint, RevoluteJoint):
                return None
            span = joint.position_upper_limit() - joint.position_lower_limit()
            return (joint, X_MB @ X) if not isfinite(span) or span > 2 * _TURNS * pi * (1 + 1e-9) else None
        return None

    def _upwards(self, joint: RevoluteJoint) -> float:
        """Return the vertical component of a joint's axis in the start configuration."""
        direction = joint.frame_on_parent().GetFixedPoseInBodyFrame().rotation() @ joint.revolute_axis()
        body = joint.parent_body()
        seen = set()
        while (inboard := self._inboard.get(int(body.index()))) is not None and body.index() not in seen:
            seen.add(body.index())
            X_MB = inboard.frame_on_child().GetFixedPoseInBodyFrame().inverse()
            direction = X_MB.rotation() @ direction
            if isinstance(inboard, WeldJoint):
                direction = inboard.X_FM().rotation() @ direction
            direction = inboard.frame_on_parent().GetFixedPoseInBodyFrame().rotation() @ direction
            body = inboard.parent_body()
        pose = self._root_poses.get(body.model_instance())
        if pose is None:
            pose = self._plant.GetDefaultFloatingBaseBodyPose(body)
        return float((pose.rotation() @ direction)[2])


def _outline(shape: Cylinder | Convex, X_JG: RigidTransform, axis: np.ndarray) -> tuple[float, float, float] | None:
    """Return radius, width and position along an axis through the origin (m) of a shape that is round about it."""
    if isinstance(shape, Cylinder):
        own = X_JG.rotation().matrix()[:, 2]
        center = X_JG.translation()
        along = float(center @ axis)
        off = float(np.linalg.norm(center - along * axis))
        fits = abs(float(own @ axis)) >= _PARALLEL and off <= _OFF_CENTER * shape.radius()
        wide = shape.length() > _WIDEST * 2 * shape.radius()
        return (shape.radius(), shape.length(), along) if fits and not wide else None
    hull = shape.GetConvexHull()
    points = (X_JG @ corners_of(hull).T).T
    along = points @ axis
    across = points - np.outer(along, axis)
    R = RotationMatrix.MakeFromOneVector(axis, 2).matrix()
    angles = np.linspace(0, 2 * pi, 72, endpoint=False)
    outline = (across @ (np.outer(R[:, 0], np.cos(angles)) + np.outer(R[:, 1], np.sin(angles)))).max(axis=0)
    radius, width = float(outline.max()), float(np.ptp(along))
    if outline.min() < _ROUND_MESH * radius or width > _WIDEST_MESH * 2 * radius or width <= 0:
        return None
    return radius, width, float(along.max() + along.min()) / 2
