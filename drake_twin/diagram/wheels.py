"""Wheels: cylinders or round meshes that rotate about their own axis.

A cylinder that lies on a plane touches in one point at one end of its line, and rounding decides which end: a base that
turns in place is up to 13 % too slow. An ellipsoid of the same radius and width touches in its middle. It is thinner
than its cylinder near the rim.

The rollers around a mecanum or an omni wheel are barrels that make it round. With faces they would be braked, with
ellipsoids of their own length the base would bounce: they are the ellipsoids that fit the wheel.
"""

from collections import Counter
from collections.abc import Mapping
from math import cos, isfinite, pi, radians, sin, sqrt

import numpy as np
from pydrake.geometry import Convex, Cylinder, Ellipsoid, Shape
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Joint, JointIndex, ModelInstanceIndex, RevoluteJoint, RigidBody, WeldJoint

from drake_twin.dataclass import dataclass
from drake_twin.description.hull import corners_of

_PARALLEL = cos(radians(1.0))  # angle between the joint's axis and the cylinder's
_OFF_CENTER = 0.02  # relative to the radius
_UPRIGHT = cos(radians(45.0))  # a body that rotates about a steeper axis than this is a turntable
_TURNS = 2.0  # a joint that can make more turns than this counts as unlimited
_WIDEST = 2.0  # width ÷ diameter
_WIDEST_MESH = 1.0
_ROUND_MESH = 0.96  # smallest ÷ largest radius of a mesh's outline

_ROLLERS = 3  # links on continuous joints that a wheel with rollers carries at least
_TANGENT = 0.1  # of a roller's axis towards the wheel's axis: its cosine
_SKEW = 0.2  # of a roller's axis from the direction of the wheel's axis: its sine
_LONGEST_ROLLER = 2.0  # length of its ellipsoid, relative to its own, and of its own, relative to its diameter


@dataclass(frozen=True)
class Wheel:
    """The shape of a wheel or of a roller.

    Attributes:
        shape: Its ellipsoid.
        X_BE: The pose of that on the body.
        is_roller: Whether it is one of several around a wheel, and bears what that bears.
    """

    shape: Ellipsoid
    X_BE: RigidTransform
    is_roller: bool


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
        self._turning = Counter(int(joint.parent_body().index()) for joint in joints if _is_unlimited(joint))

    def wheel(self, body: RigidBody, shape: Shape, X_BG: RigidTransform) -> Wheel | None:
        """Return a wheel's or a roller's shape as contact uses it; None for a shape that is not a wheel's."""
        if not isinstance(shape, Cylinder | Convex):
            return None
        turned = self._turned_about(body)
        if turned is None:
            return None
        joint, X_JB = turned  # J is the joint's frame M on its child
        axis = joint.revolute_axis()
        X_JG = X_JB @ X_BG
        found = _outline(shape, X_JG, axis)
        if found is None:
            return None
        radius, width, along = found
        X_BE = X_JB.inverse() @ RigidTransform(RotationMatrix.MakeFromOneVector(axis, 2), along * axis)
        if (half := self._roller(joint, radius, width / 2, along)) is not None:
            return Wheel(Ellipsoid(radius, radius, half), X_BE, is_roller=True)
        widest = _WIDEST if isinstance(shape, Cylinder) else _WIDEST_MESH
        if width > widest * 2 * radius or abs(self._upwards(joint)) > _UPRIGHT:
            return None
        return Wheel(Ellipsoid(radius, radius, width / 2), X_BE, is_roller=False)

    def _roller(self, joint: RevoluteJoint, radius: float, half: float, along: float) -> float | None:
        """Return half the length of the ellipsoid of a roller of a wheel (m); None for what is not a roller.

        Where a wheel of n rollers has turned by 180° ÷ n from its lowest roller, the ground is as far from its axis as
        below that roller's middle.
        """
        wheel, count = self._turned_about(joint.parent_body()), self._turning[int(joint.parent_body().index())]
        if wheel is None or count < _ROLLERS:
            return None
        carrier, X_WP = wheel
        if abs(self._upwards(carrier)) > _UPRIGHT or half > _LONGEST_ROLLER * 2 * radius:
            return None
        X_WJ = X_WP @ joint.frame_on_parent().GetFixedPoseInBodyFrame()
        direction, axis = X_WJ.rotation() @ joint.revolute_axis(), carrier.revolute_axis()
        outwards = np.cross(axis, np.cross(X_WJ @ (along * joint.revolute_axis()), axis))
        apart, skew = float(np.linalg.norm(outwards)), float(np.linalg.norm(np.cross(axis, direction)))
        if apart <= radius or skew < _SKEW or abs(float(direction @ outwards)) > _TANGENT * apart:
            return None
        rise = (skew * sin(pi / count)) ** 2  # of the roller's axis from the ground: its sine squared
        reach = apart + radius - apart * cos(pi / count)
        return min(sqrt((reach**2 - radius**2 * (1 - rise)) / rise), _LONGEST_ROLLER * half)

    def _turned_about(self, body: RigidBody) -> tuple[RevoluteJoint, RigidTransform] | None:
        """Return the continuous joint that turns a body or what it is welded to, and the body's pose in it."""
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
            return (joint, X_MB @ X) if _is_unlimited(joint) else None
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


def _is_unlimited(joint: Joint) -> bool:
    if not isinstance(joint, RevoluteJoint):
        return False
    span = joint.position_upper_limit() - joint.position_lower_limit()
    return not isfinite(span) or span > 2 * _TURNS * pi * (1 + 1e-9)


def _outline(shape: Cylinder | Convex, X_JG: RigidTransform, axis: np.ndarray) -> tuple[float, float, float] | None:
    """Return radius, width and position along an axis through the origin (m) of a shape that is round about it."""
    if isinstance(shape, Cylinder):
        own = X_JG.rotation().matrix()[:, 2]
        center = X_JG.translation()
        along = float(center @ axis)
        off = float(np.linalg.norm(center - along * axis))
        fits = abs(float(own @ axis)) >= _PARALLEL and off <= _OFF_CENTER * shape.radius()
        return (shape.radius(), shape.length(), along) if fits else None
    hull = shape.GetConvexHull()
    points = (X_JG @ corners_of(hull).T).T
    along = points @ axis
    across = points - np.outer(along, axis)
    R = RotationMatrix.MakeFromOneVector(axis, 2).matrix()
    angles = np.linspace(0, 2 * pi, 72, endpoint=False)
    outline = (across @ (np.outer(R[:, 0], np.cos(angles)) + np.outer(R[:, 1], np.sin(angles)))).max(axis=0)
    radius, width = float(outline.max()), float(np.ptp(along))
    if outline.min() < _ROUND_MESH * radius or width <= 0:
        return None
    return radius, width, float(along.max() + along.min()) / 2
