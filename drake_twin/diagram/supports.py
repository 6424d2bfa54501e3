"""The supports of robots: the wheels, casters and feet that stand on the ground at the start.

A shape is as stiff as its link is heavy. Where a robot of light wheels and a heavy base with a caster is dropped, the
caster would take most of the blow, and tip the robot over if its center of mass is near the wheels. So where the center
of the supports' stiffness is far from the center of mass, the stiffness of each follows from the weight that it bears:
all of them sink in alike, and land alike.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from math import fsum

import numpy as np
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.geometry import CalcVolume, Convex
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Joint, PrismaticJoint, RevoluteJoint, RigidBody, WeldJoint

from drake_twin.dataclass import dataclass
from drake_twin.description.hull import corners_of
from drake_twin.diagram.contact_material import usual_stiffness
from drake_twin.diagram.contact_models import ContactModel
from drake_twin.diagram.contact_shapes import POINT_STIFFNESS, STIFFEST, ContactShape, Support, reach_of

_LEVEL = 3e-3  # m above the lowest support: casters may hang a little above the ground
_NEAR = 0.5  # of the way from the center of mass to the nearest edge between the supports
_LEAST = 0.02  # of the robot's weight: what bears less may have to bear more in motion
_FLAT = 1e-3  # relative to a hull's height, between the corners that it stands on
_POINTED = 0.05  # area of the face that a hull stands on, relative to the rectangle around it: less is round
_DIGITS = 9  # of a share: the last bits of what is solved differ between NumPy's versions
_MOST = 32  # supports of one robot


@dataclass(frozen=True)
class _Body:
    X_WB: RigidTransform
    mass: float  # kg
    center: np.ndarray  # in the world (m)


def share_weight(
    plant: MultibodyPlant, shapes: Sequence[ContactShape], models: Sequence[ContactModel]
) -> list[ContactShape]:
    """Return shapes, where supports of robots that would tip over on landing have the stiffness for what they bear.

    Args:
        plant: The plant, not yet finalized.
        shapes: All shapes.
        models: The robots and the moving models of the world.
    """
    found = list(shapes)
    inboard = {int(joint.child_body().index()): joint for joint in map(plant.get_joint, plant.GetJointIndices())}
    of_model: dict[str, dict[int, ContactShape]] = {}
    for index, shape in enumerate(shapes):
        if shape.group is not None:
            of_model.setdefault(shape.group.model, {})[index] = shape
    for model in models:
        own = of_model.get(model.name, {})
        if not own or any(shape.is_loose or shape.is_roller for shape in own.values()):
            continue
        bodies = _bodies(plant, model, inboard)
        if bodies is not None:
            for index, support in _supports(own, bodies):
                is_flat = found[index].is_flat and support.area > 0
                found[index] = replace(found[index], support=support, is_flat=is_flat)
    return found


def _bodies(plant: MultibodyPlant, model: ContactModel, inboard: Mapping[int, Joint]) -> dict[int, _Body] | None:
    """Return a robot's bodies at the start, by the joint above each; None if it does not move freely."""
    found: dict[int, _Body] = {}

    def pose(body: RigidBody) -> RigidTransform | None:
        if (known := found.get(int(body.index()))) is not None:
            return known.X_WB
        if body.index() == plant.world_body().index():
            return None
        joint = inboard.get(int(body.index()))
        if joint is None:
            X = model.root_pose or plant.GetDefaultFloatingBaseBodyPose(body)
        else:
            X_WP = pose(joint.parent_body())
            if X_WP is None:
                return None
            X = X_WP @ _across(joint)
        found[int(body.index())] = _Body(X, body.default_mass(), X @ body.default_com())
        return X

    for instance in model.instances:
        for index in plant.GetBodyIndices(instance):
            if pose(plant.get_body(index)) is None:
                return None
    return found


def _across(joint: Joint) -> RigidTransform:
    """Return the pose of a joint's child body on its parent body at the start."""
    X_FM = RigidTransform()
    if isinstance(joint, WeldJoint):
        X_FM = joint.X_FM()
    elif isinstance(joint, RevoluteJoint):
        X_FM = RigidTransform(RotationMatrix(AngleAxis(joint.default_positions()[0], joint.revolute_axis())), [0, 0, 0])
    elif isinstance(joint, PrismaticJoint):
        X_FM = RigidTransform(joint.default_positions()[0] * joint.translation_axis())
    X_PF, X_CM = (frame.GetFixedPoseInBodyFrame() for frame in (joint.frame_on_parent(), joint.frame_on_child()))
    return X_PF @ X_FM @ X_CM.inverse()


def _supports(shapes: dict[int, ContactShape], bodies: dict[int, _Body]) -> Iterator[tuple[int, Support]]:
    """Yield the shapes on which a robot stands, and their stiffness, if that has to follow from what they bear."""
    poses = {index: bodies[int(shape.body.index())].X_WB @ shape.X_BG for index, shape in shapes.items()}
    heights = {
        index: float(X.translation()[2]) - reach_of(shapes[index].shape, -X.rotation().matrix()[2])
        for index, X in poses.items()
    }
    lowest = min(heights.values())
    feet = [index for index, height in heights.items() if height < lowest + _LEVEL]
    if not 3 <= len(feet) <= _MOST:
        return
    mass = fsum(body.mass for body in bodies.values())
    center = np.array([body.mass * body.center for body in bodies.values()]).sum(axis=0)[:2] / mass
    places = np.array([_place(shapes[index], poses[index])[:2] for index in feet]) - center
    usual = np.array([usual_stiffness(shapes[index]) for index in feet])
    if np.linalg.norm(usual @ places) <= _NEAR * _margin(places) * usual.sum():
        return
    shares = _shares(places, usual)
    if shares is None:
        return
    shares = np.round(np.maximum(shares, _LEAST), _DIGITS)
    for index, share in zip(feet, shares / shares.sum(), strict=True):
        shape, X = shapes[index], poses[index]
        stiffness = min(POINT_STIFFNESS * mass * float(share), STIFFEST * shape.own_mass)
        down = -X.rotation().matrix()[2]
        height = reach_of(shape.shape, down) + reach_of(shape.shape, -down)
        area = _sole(shape, X) if isinstance(shape.shape, Convex) else CalcVolume(shape.shape) / height
        yield index, Support(stiffness, area, height)


def _place(shape: ContactShape, X_WG: RigidTransform) -> np.ndarray:
    """Return where a shape stands on the ground (m): below the middle of its lowest corners, or below its own."""
    return np.asarray(X_WG.translation()) if not isinstance(shape.shape, Convex) else _lowest(shape, X_WG).mean(axis=0)


def _lowest(shape: ContactShape, X_WG: RigidTransform) -> np.ndarray:
    """Return the lowest corners of a hull in the world (n×3, m)."""
    corners = (X_WG @ corners_of(shape.shape.GetConvexHull()).T).T
    return np.asarray(corners[corners[:, 2] < corners[:, 2].min() + _FLAT * np.ptp(corners[:, 2])])


def _sole(shape: ContactShape, X_WG: RigidTransform) -> float:
    """Return the area of the face that a hull stands on (m²); zero for one that stands on an edge or a corner."""
    points = _lowest(shape, X_WG)[:, :2] - _lowest(shape, X_WG)[:, :2].mean(axis=0)
    x, y = points[np.argsort(np.arctan2(points[:, 1], points[:, 0]), kind="stable")].T
    area = abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
    corners = X_WG.rotation().matrix()[:2] @ corners_of(shape.shape.GetConvexHull()).T
    return area if area > _POINTED * float(np.ptp(corners, axis=1).prod()) else 0.0


def _margin(places: np.ndarray) -> float:
    """Return how far the origin is from the nearest edge around points of the plane (n×2, m); zero outside."""
    nearest = np.inf
    for one, other in combinations(places, 2):
        along = other - one
        length = float(np.linalg.norm(along))
        if length < 1e-6:
            continue
        across = np.array((-along[1], along[0])) / length
        sides = (places - one) @ across
        if sides.min() < -1e-6 < 1e-6 < sides.max():
            continue
        inwards = 1.0 if sides.max() > 1e-6 else -1.0
        nearest = min(nearest, inwards * float(-one @ across))
    return max(nearest, 0.0) if np.isfinite(nearest) else 0.0


def _shares(places: np.ndarray, stiffness: np.ndarray) -> np.ndarray | None:
    """Return which part of the weight each support bears, as springs under a rigid body whose center is the origin.

    Returns:
        The parts, none of them negative; None if the body does not stand on them.
    """
    bears = np.ones(len(places), dtype=bool)
    while bears.sum() >= 3:
        A = np.vstack([np.ones(bears.sum()), places[bears].T])
        K = stiffness[bears]
        scale = np.abs(A).max(axis=1, keepdims=True)
        A = A / np.maximum(scale, 1e-9)
        W = (A * K) @ A.T
        if np.linalg.cond(W) > 1e9:
            return None
        found = K * (A.T @ np.linalg.solve(W, np.array((1.0 / scale[0, 0], 0.0, 0.0))))
        if found.min() > -1e-9:
            shares = np.zeros(len(places))
            shares[bears] = np.maximum(found, 0.0)
            return shares
        bears[np.flatnonzero(bears)[int(found.argmin())]] = False
    return None
