"""The boxes that robots and moving models stay in, whatever their joints do."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from math import inf, isfinite

import numpy as np
from pydrake.geometry import SceneGraphInspector
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, Joint, JointIndex, QuaternionFloatingJoint, WeldJoint
from pydrake.systems.framework import Context

from drake_twin.dataclass import dataclass
from drake_twin.islands.mover import Mover

_TURNS = ("revolute", "continuous")

# What contact may see beyond a body, and what a body may gain in speed within a frame, is within this (m).
MARGIN = 0.02

_ROUNDING = 1e-6  # m


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
        speeds: How fast the corners of each are at most (m/s), as of the last call of `swept`.
    """

    def __init__(self, plant: MultibodyPlant, inspector: SceneGraphInspector, movers: Sequence[Mover]):
        self._plant = plant
        anchors = [
            anchor for number, mover in enumerate(movers) for anchor in _anchors(plant, inspector, number, mover)
        ]
        self._anchors = anchors
        self.owners = np.array([anchor.mover for anchor in anchors], dtype=int)
        self._lower, self._upper = np.zeros((len(anchors), 3)), np.zeros((len(anchors), 3))
        self.speeds = np.zeros(len(anchors))
        self._moving = np.zeros(0, dtype=bool)
        self._rows = _Rows(anchors, np.arange(len(anchors)))
        self._radius = np.array([anchor.radius for anchor in anchors])
        self._free = np.array([anchor.q is not None for anchor in anchors], dtype=bool)
        starts = [0 if anchor.q is None else anchor.q + 4 for anchor in anchors]
        self._origins = np.add.outer(np.array(starts, dtype=int), np.arange(3))
        self._clearance: _Clearance | None = None

    def measure(self, state: np.ndarray) -> None:
        """Measure how far each that may move may go, with its speed, before it can come near another one."""
        rows = self._rows.rows
        self._clearance = None
        if not self._free.all() or not np.isfinite(self._radius).all():
            return
        p = state[self._origins]
        # The largest of the axes' distances, as of boxes, which reach beyond the spheres.
        gaps = np.abs(p[rows][:, np.newaxis] - p).max(axis=2) - self._radius[rows][:, np.newaxis] - self._radius
        gaps[self.owners[rows][:, np.newaxis] == self.owners] = inf
        slack = 0.5 * gaps.min(axis=1, initial=inf) - MARGIN - _ROUNDING
        velocities = self._rows.velocities()
        self._clearance = _Clearance(self._origins[rows], velocities, p[rows], slack, self._radius[rows])

    def are_clear(self, state: np.ndarray, duration: float) -> bool:
        """Tell whether none has come near another one since it was measured, nor can in a time (s)."""
        known = self._clearance
        if known is None:
            return False
        way, v = state[known.origins] - known.starts, state[known.velocities]
        length, turning, moving = (np.sqrt(np.einsum("ni,ni->n", part, part)) for part in (way, v[:, :3], v[:, 3:]))
        reach = length + duration * (moving + turning * known.arms)
        return bool((reach <= known.slack).all())

    def swept(
        self, state: np.ndarray, context: Context, duration: float, moving: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the lower and upper corners of the boxes that the movers stay in for a time, each shape (boxes, 3).

        Args:
            state: The plant's ``[q; v]``.
            context: The plant's context with this state.
            duration: The time (s).
            moving: Which movers may move, shape (movers,); the others are where they were before.

        Returns:
            The corners, and the boxes of those that may move.
        """
        if moving.tobytes() != self._moving.tobytes():
            everyone = _Rows(self._anchors, np.arange(len(self._anchors)))
            self._lower, self._upper, _ = everyone.swept(self._plant, state, context, 0.0)
            self.speeds = np.zeros(len(self._anchors))
            self._moving, self._rows = moving.copy(), _Rows(self._anchors, np.flatnonzero(moving[self.owners]))
        rows = self._rows.rows
        self._lower[rows], self._upper[rows], self.speeds[rows] = self._rows.swept(
            self._plant, state, context, duration
        )
        return self._lower, self._upper, rows

    def forget(self) -> None:
        """Know that those that do not move may be elsewhere."""
        self._clearance = None
        self._moving = np.zeros(0, dtype=bool)


@dataclass(frozen=True, eq=False)
class _Clearance:
    """Where boxes were, how far each may go, and its radius; the places of origins and velocities in the state."""

    origins: np.ndarray
    velocities: np.ndarray
    starts: np.ndarray
    slack: np.ndarray
    arms: np.ndarray


class _Rows:
    """Some of the boxes, as arrays."""

    def __init__(self, anchors: Sequence[Anchor], rows: np.ndarray):
        self.rows = rows
        own = [anchors[row] for row in rows.tolist()]
        self._center = np.array([anchor.center for anchor in own]).reshape(-1, 3, 1)
        half = np.array([anchor.half for anchor in own]).reshape(-1, 3, 1)
        self._radius = np.array([anchor.radius for anchor in own])
        self._arms = np.where(np.isfinite(self._radius), self._radius, 0.0)
        self._is_endless = ~np.isfinite(self._radius)
        self._half = np.where(np.isfinite(half), half, 0.0)
        self._free = np.array([index for index, anchor in enumerate(own) if anchor.q is not None], dtype=int)
        self._are_free = len(self._free) == len(own)
        self._others = [(index, anchor.body) for index, anchor in enumerate(own) if anchor.q is None]
        starts = [(anchor.q, anchor.v) for anchor in own if anchor.q is not None and anchor.v is not None]
        self._q = np.add.outer(np.array([q for q, _ in starts], dtype=int), np.arange(7))
        self._v = np.add.outer(np.array([v for _, v in starts], dtype=int), np.arange(6))

    def swept(
        self, plant: MultibodyPlant, state: np.ndarray, context: Context, duration: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the corners of the boxes for a time (s), and how fast their corners are at most (m/s)."""
        q, v = state[self._q], state[self._v]
        R, p = _rotations(q[:, :4]), q[:, 4:]
        turning, moving = (np.sqrt((part * part).sum(axis=1)) for part in (v[:, :3], v[:, 3:]))
        if not self._are_free:
            R, p, turning, moving = self._with_others(plant, context, R, p, turning, moving)
        reach = (np.abs(R) @ self._half)[:, :, 0]
        speed = moving + turning * self._arms
        reach += (speed * duration + MARGIN)[:, np.newaxis]
        reach[self._is_endless] = inf
        center = p + (R @ self._center)[:, :, 0]
        return center - reach, center + reach, speed

    def velocities(self) -> np.ndarray:
        """Return the places of the free boxes' angular and linear velocities in the state, shape (boxes, 6)."""
        places: np.ndarray = self._v
        return places

    def _with_others(
        self,
        plant: MultibodyPlant,
        context: Context,
        R: np.ndarray,
        p: np.ndarray,
        turning: np.ndarray,
        moving: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return the poses and speeds of all boxes, given those of the free ones."""
        count = len(self.rows)
        rotations, places, speeds = np.empty((count, 3, 3)), np.empty((count, 3)), np.empty((2, count))
        rotations[self._free], places[self._free], speeds[:, self._free] = R, p, (turning, moving)
        for index, body_index in self._others:
            body = plant.get_body(body_index)
            X_WB, V_WB = body.EvalPoseInWorld(context), body.EvalSpatialVelocityInWorld(context)
            rotations[index], places[index] = X_WB.rotation().matrix(), X_WB.translation()
            speeds[:, index] = np.linalg.norm(V_WB.rotational()), np.linalg.norm(V_WB.translational())
        return rotations, places, speeds[0], speeds[1]


def _rotations(quaternions: np.ndarray) -> np.ndarray:
    """Return the rotation matrices of quaternions (w, x, y, z) of any length, shape (quaternions, 3, 3)."""
    scaled = quaternions * np.sqrt(2.0 / (quaternions * quaternions).sum(axis=1))[:, np.newaxis]
    products = scaled[:, :, np.newaxis] * scaled[:, np.newaxis, :]
    R: np.ndarray = (products.reshape(-1, 16) @ _PRODUCTS + _ONES).reshape(-1, 3, 3)
    return R


def _table() -> np.ndarray:
    """Return what each product of two elements of a quaternion, of length √2, adds to each element of its matrix."""
    w, x, y, z = range(4)
    sums = {
        (0, 0): ((-1, y, y), (-1, z, z)),
        (0, 1): ((1, x, y), (-1, w, z)),
        (0, 2): ((1, x, z), (1, w, y)),
        (1, 0): ((1, x, y), (1, w, z)),
        (1, 1): ((-1, x, x), (-1, z, z)),
        (1, 2): ((1, y, z), (-1, w, x)),
        (2, 0): ((1, x, z), (-1, w, y)),
        (2, 1): ((1, y, z), (1, w, x)),
        (2, 2): ((-1, x, x), (-1, y, y)),
    }
    table = np.zeros((16, 9))
    for (row, column), terms in sums.items():
        for sign, one, other in terms:
            table[4 * one + other, 3 * row + column] += sign
    return table


_PRODUCTS, _ONES = _table(), np.eye(3).ravel()


def _anchors(plant: MultibodyPlant, inspector: SceneGraphInspector, number: int, mover: Mover) -> list[Anchor]:
    below: Mapping[BodyIndex, list[Joint]] = defaultdict(list)
    hanging = set()
    world = plant.world_body().index()
    for joint in map(plant.get_joint, map(JointIndex, mover.places.joints)):
        if joint.parent_body().index() != world or joint.type_name() != QuaternionFloatingJoint.kTypeName:
            below[joint.parent_body().index()].append(joint)
            hanging.add(joint.child_body().index())
    starts = [index for index in mover.places.bodies if index not in hanging]
    jointed = below.get(world, [])
    boxes = _boxes(plant, inspector, [*starts, *(joint.child_body().index() for joint in jointed)], below)
    found = []
    for joint in jointed:
        body = joint.child_body()
        lower, upper = _hanging(joint, *boxes[body.index()])
        if np.isfinite(lower).all() and np.isfinite(upper).all():
            found.append(_anchor(number, world, None, None, lower, upper))
            continue
        while not plant.GetCollisionGeometriesForBody(body) and len(below.get(body.index(), ())) == 1:
            body = below[body.index()][0].child_body()  # what a planar base moves is a body, and no way of its joints
        starts.append(body.index())
    for index in starts:
        body, (lower, upper) = plant.get_body(index), boxes[index]
        if (lower <= upper).all():  # else it has no shape
            is_free = body.is_floating_base_body() and body.has_quaternion_dofs()
            q = body.floating_positions_start() if is_free else None
            v = plant.num_positions() + body.floating_velocities_start_in_v() if is_free else None
            found.append(_anchor(number, index, q, v, lower, upper))
    return found


def _anchor(number: int, body: BodyIndex, q: int | None, v: int | None, lower: np.ndarray, upper: np.ndarray) -> Anchor:
    if not np.isfinite(lower).all():
        return Anchor(number, body, q, v, np.zeros(3), np.full(3, inf), inf)
    center, half = (upper + lower) / 2, (upper - lower) / 2
    radius = float(np.linalg.norm(np.abs(center) + half))
    return Anchor(number, body, q, v, center, half, radius)


def _boxes(
    plant: MultibodyPlant,
    inspector: SceneGraphInspector,
    starts: Sequence[BodyIndex],
    below: Mapping[BodyIndex, list[Joint]],
) -> dict[BodyIndex, tuple[np.ndarray, np.ndarray]]:
    """Return the corners of the box, in each body's frame, of its shapes and of all that hangs on it."""
    order = list(starts)
    for index in order:
        order += [joint.child_body().index() for joint in below.get(index, ())]
    boxes: dict[BodyIndex, tuple[np.ndarray, np.ndarray]] = {}
    for index in reversed(order):
        lower, upper = _own_box(plant, inspector, index)
        for joint in below.get(index, ()):
            least, most = _hanging(joint, *boxes[joint.child_body().index()])
            lower, upper = np.minimum(lower, least), np.maximum(upper, most)
        boxes[index] = lower, upper
    return boxes


def _own_box(plant: MultibodyPlant, inspector: SceneGraphInspector, index: BodyIndex) -> tuple[np.ndarray, np.ndarray]:
    lower, upper = np.full(3, inf), np.full(3, -inf)
    for geometry in plant.GetCollisionGeometriesForBody(plant.get_body(index)):
        box = inspector.GetObbInGeometryFrame(geometry)
        if box is None:
            return np.full(3, -inf), np.full(3, inf)
        X_BO = inspector.GetPoseInFrame(geometry) @ box.pose()
        reach = np.abs(X_BO.rotation().matrix()) @ box.half_width()
        lower, upper = np.minimum(lower, X_BO.translation() - reach), np.maximum(upper, X_BO.translation() + reach)
    return lower, upper


def _hanging(joint: Joint, lower: np.ndarray, upper: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of the box, in the frame of a joint's parent, of all that the joint moves.

    Args:
        joint: The joint.
        lower: The lower corner of the box of its child, in the child's frame.
        upper: The upper one.
    """
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
    elif isinstance(joint, WeldJoint):
        lower, upper = _moved(joint.X_FM(), lower, upper)
    else:
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
