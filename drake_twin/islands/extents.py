"""The boxes that robots and moving models stay in, whatever their joints do."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from math import inf, isfinite

import numpy as np
from pydrake.geometry import SceneGraphInspector
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, Joint, QuaternionFloatingJoint
from pydrake.systems.framework import Context

from drake_twin.dataclass import dataclass
from drake_twin.islands.mover import Mover

_TURNS = ("revolute", "continuous")

# What contact may see beyond a body, and what a body may gain in speed within a frame, is within this (m).
MARGIN = 0.02


@dataclass(frozen=True, eq=False)
class Anchor:
    """A body of a mover, with the box of all that hangs on it.

    Attributes:
        mover: The mover's number.
        body: The body.
        q: The place of its quaternion and position in the plant's state; None for one that is not free.
        v: The place of its angular and linear velocity there.
        center: The box's center in the body's frame (m).
        half: Half of its side lengths (m).
        radius: The distance of its farthest corner from the body's origin (m).
    """

    mover: int
    body: BodyIndex
    q: int | None
    v: int | None
    center: np.ndarray
    half: np.ndarray
    radius: float


class Extents:
    """The boxes of all movers in the world.

    Args:
        plant: The plant that holds their state.
        inspector: Of its shapes.
        movers: The movers.

    Attributes:
        owners: The number of each box's mover.
    """

    def __init__(self, plant: MultibodyPlant, inspector: SceneGraphInspector, movers: Sequence[Mover]):
        self._plant = plant
        anchors = [
            anchor for number, mover in enumerate(movers) for anchor in _anchors(plant, inspector, number, mover)
        ]
        self.owners = np.array([anchor.mover for anchor in anchors], dtype=int)
        self._center = np.array([anchor.center for anchor in anchors]).reshape(-1, 3)
        self._half = np.array([anchor.half for anchor in anchors]).reshape(-1, 3)
        self._radius = np.array([anchor.radius for anchor in anchors])
        self._free = np.array([index for index, anchor in enumerate(anchors) if anchor.q is not None], dtype=int)
        self._others = [(index, anchor.body) for index, anchor in enumerate(anchors) if anchor.q is None]
        starts = [(anchor.q, anchor.v) for anchor in anchors if anchor.q is not None and anchor.v is not None]
        self._q = np.add.outer(np.array([q for q, _ in starts], dtype=int), np.arange(7))
        self._v = np.add.outer(np.array([v for _, v in starts], dtype=int), np.arange(6))

    def swept(self, state: np.ndarray, context: Context, duration: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the lower and upper corners of the boxes that the movers stay in for a time, each shape (boxes, 3).

        Args:
            state: The plant's ``[q; v]``.
            context: The plant's context with this state.
            duration: The time (s).
        """
        count = len(self.owners)
        R, p, speed = np.empty((count, 3, 3)), np.empty((count, 3)), np.zeros(count)
        q, v = state[self._q], state[self._v]
        R[self._free], p[self._free] = _rotations(q[:, :4]), q[:, 4:]
        speed[self._free] = _lengths(v[:, 3:]) + _lengths(v[:, :3]) * self._radius[self._free]
        for index, body_index in self._others:
            body = self._plant.get_body(body_index)
            X_WB, V_WB = body.EvalPoseInWorld(context), body.EvalSpatialVelocityInWorld(context)
            R[index], p[index] = X_WB.rotation().matrix(), X_WB.translation()
            turning = float(np.linalg.norm(V_WB.rotational()))
            speed[index] = np.linalg.norm(V_WB.translational()) + (turning * self._radius[index] if turning else 0.0)
        center = p + np.einsum("nij,nj->ni", R, self._center)
        reach = np.einsum("nij,nj->ni", np.abs(R), np.where(np.isfinite(self._half), self._half, 0.0))
        reach[~np.isfinite(self._half).all(axis=1)] = inf
        reach += (speed * duration + MARGIN)[:, np.newaxis]
        return center - reach, center + reach


def _lengths(vectors: np.ndarray) -> np.ndarray:
    lengths: np.ndarray = np.sqrt(np.einsum("ni,ni->n", vectors, vectors))
    return lengths


def _rotations(quaternions: np.ndarray) -> np.ndarray:
    """Return the rotation matrices of quaternions (w, x, y, z) of any length."""
    w, x, y, z = (quaternions / _lengths(quaternions)[:, np.newaxis]).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def _anchors(plant: MultibodyPlant, inspector: SceneGraphInspector, number: int, mover: Mover) -> list[Anchor]:
    joints = [
        plant.get_joint(index) for instance in mover.places.instances for index in plant.GetJointIndices(instance)
    ]
    below: Mapping[BodyIndex, list[Joint]] = defaultdict(list)
    children = set()
    floating = set()
    for joint in joints:
        if joint.type_name() == QuaternionFloatingJoint.kTypeName and joint.parent_body() is plant.world_body():
            floating.add(joint.child_body().index())
            continue
        below[joint.parent_body().index()].append(joint)
        children.add(joint.child_body().index())
    found = []
    nq = plant.num_positions()
    for index in mover.places.bodies:
        body = plant.get_body(index)
        if index in children:
            continue
        lower, upper = _box(plant, inspector, index, below)
        if not (lower <= upper).all():
            continue  # it has no shape
        is_free = body.is_floating_base_body() and body.has_quaternion_dofs()
        q = body.floating_positions_start() if is_free else None
        v = nq + body.floating_velocities_start_in_v() if is_free else None
        found.append(_anchor(number, index, q, v, lower, upper))
    for joint in below.get(plant.world_body().index(), ()):
        body = joint.child_body()
        while not plant.GetCollisionGeometriesForBody(body) and len(below.get(body.index(), ())) == 1:
            body = below[body.index()][0].child_body()  # what a planar base moves is a body, and no way of its joints
        lower, upper = _box(plant, inspector, body.index(), below)
        if (lower <= upper).all():
            found.append(_anchor(number, body.index(), None, None, lower, upper))
    return found


def _anchor(number: int, body: BodyIndex, q: int | None, v: int | None, lower: np.ndarray, upper: np.ndarray) -> Anchor:
    if not np.isfinite(lower).all():
        return Anchor(number, body, q, v, np.zeros(3), np.full(3, inf), inf)
    center, half = (upper + lower) / 2, (upper - lower) / 2
    radius = float(np.linalg.norm(np.abs(center) + half))
    return Anchor(number, body, q, v, center, half, radius)


def _box(
    plant: MultibodyPlant, inspector: SceneGraphInspector, index: BodyIndex, below: Mapping[BodyIndex, list[Joint]]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of the box, in a body's frame, of its shapes and of all that hangs on it."""
    lower, upper = np.full(3, inf), np.full(3, -inf)
    body = plant.get_body(index)
    for geometry in plant.GetCollisionGeometriesForBody(body):
        box = inspector.GetObbInGeometryFrame(geometry)
        if box is None:
            return np.full(3, -inf), np.full(3, inf)
        X_BO = inspector.GetPoseInFrame(geometry) @ box.pose()
        reach = np.abs(X_BO.rotation().matrix()) @ box.half_width()
        lower, upper = np.minimum(lower, X_BO.translation() - reach), np.maximum(upper, X_BO.translation() + reach)
    for joint in below.get(index, ()):
        least, most = _hanging(plant, inspector, joint, below)
        lower, upper = np.minimum(lower, least), np.maximum(upper, most)
    return lower, upper


def _hanging(
    plant: MultibodyPlant, inspector: SceneGraphInspector, joint: Joint, below: Mapping[BodyIndex, list[Joint]]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of the box, in the frame of a joint's parent, of all that the joint moves."""
    lower, upper = _box(plant, inspector, joint.child_body().index(), below)
    if not (lower <= upper).all():
        return lower, upper
    X_BM = joint.frame_on_child().GetFixedPoseInBodyFrame()
    lower, upper = _moved(X_BM.inverse(), lower, upper)
    kind, far = joint.type_name(), np.maximum(np.abs(lower), np.abs(upper))
    if kind in _TURNS:
        axis = np.abs(joint.revolute_axis())
        along = axis @ far
        across = float(np.linalg.norm(far))
        reach = np.minimum(np.full(3, across), axis * along + across * np.sqrt(np.clip(1.0 - axis**2, 0.0, 1.0)))
        lower, upper = -reach, reach
    elif kind == "prismatic":
        axis = joint.translation_axis()
        ends = [float(joint.position_lower_limits()[0]), float(joint.position_upper_limits()[0])]
        if not all(map(isfinite, ends)):
            return np.full(3, -inf), np.full(3, inf)
        ways = np.outer([ends[0] - MARGIN, ends[1] + MARGIN], axis)
        lower, upper = lower + ways.min(axis=0), upper + ways.max(axis=0)
    elif kind != "weld":
        if joint.num_positions() not in (2, 3, 4) or kind in ("planar", "prismatic"):
            return np.full(3, -inf), np.full(3, inf)
        reach = np.full(3, float(np.linalg.norm(far)))
        lower, upper = -reach, reach
    return _moved(joint.frame_on_parent().GetFixedPoseInBodyFrame(), lower, upper)


def _moved(X: RigidTransform, lower: np.ndarray, upper: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    if not np.isfinite(lower).all():
        return np.full(3, -inf), np.full(3, inf)
    center, half = (lower + upper) / 2, (upper - lower) / 2
    middle = X.rotation().matrix() @ center + X.translation()
    reach = np.abs(X.rotation().matrix()) @ half
    return middle - reach, middle + reach
