"""How links of a mechanism respond to wrenches on them, from what is known before the plant takes its step.

A force that follows from a link's acceleration, as that of added mass, or that has to be stable in a step however large
it is, needs the acceleration that the link has without it. The plant knows that only once its solver has found the
forces of joints and contacts, which would be an algebraic loop. What can be known before is prepared here.
"""

from collections.abc import Sequence

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, JacobianWrtVariable, Joint, RigidBody
from pydrake.systems.framework import Context

from drake_twin.control.cross_product import cross
from drake_twin.control.fossen import coriolis
from drake_twin.controllers.body_forces import Motion
from drake_twin.errors import InputError


class LinkResponse:
    """The response of links to wrenches, with all joints as they are at the start.

    The response to wrenches on the links is that of the whole mechanism, J M⁻¹ Jᵀ, so that a light link on a heavy
    robot is as heavy as it feels, and one on a joint as light. The wrench of all other forces on a link is the sum over
    what moves with it, as if that were one rigid body: the whole robot where that is free, else what hangs on the
    link. It lacks the forces of contacts, of motors and of joints of a robot that is fixed to the world.

    Args:
        plant: The finalized plant.
        links: The links; those of one mechanism respond to each other.
        masses: A context of the plant with the masses and inertias; without it those are as built.

    Attributes:
        carried: The bodies that move with the links, link by link.
        groups: For each number of links in a mechanism the indices of its links (g×k).
        responses: For each of `groups` the accelerations for wrenches on its links (g×6k×6k).
        own: For each link the acceleration for a wrench on it (n×6×6); angular (rad/s² and m/s² for N·m and N).
    """

    def __init__(self, plant: MultibodyPlant, links: Sequence[RigidBody], masses: Context | None = None):
        context = plant.CreateDefaultContext()
        if masses is not None:
            start = plant.GetPositions(context)
            context.SetTimeStateAndParametersFrom(masses)
            plant.SetPositions(context, start)
        inboard = {joint.child_body().index(): joint for joint in map(plant.get_joint, plant.GetJointIndices())}
        gravity = np.array(plant.gravity_field().gravity_vector())
        self.carried: list[RigidBody] = []
        owners: list[int] = []
        inertias, weights = [], []
        mechanisms: dict[int, list[int]] = {}
        for number, link in enumerate(links):
            base = _base(inboard, link)
            mechanisms.setdefault(int(base.index()), []).append(number)
            bodies = _carried(plant, inboard, link, base)
            self.carried += bodies
            owners += [number] * len(bodies)
            indices = [body.index() for body in bodies]
            inertias.append(plant.CalcSpatialInertia(context, link.body_frame(), indices).CopyToFullMatrix6())
            falling = [body.index() for body in bodies if plant.is_gravity_enabled(body.model_instance())]
            weight = np.zeros(4)
            if falling:
                fallen = plant.CalcSpatialInertia(context, link.body_frame(), falling)
                weight = fallen.get_mass() * np.array([1.0, *fallen.get_com()])
            weights.append(weight)
        self._inertias = np.array(inertias)
        self._masses, self._moments = np.array(weights)[:, :1], np.array(weights)[:, 1:]
        self._gravity = gravity
        self._owners = np.array(owners, dtype=int)
        self._sums = np.zeros((len(links), len(owners)))
        self._sums[self._owners, np.arange(len(owners))] = 1.0
        jacobians = [
            plant.CalcJacobianSpatialVelocity(
                context,
                JacobianWrtVariable.kV,
                link.body_frame(),
                np.zeros(3),
                plant.world_frame(),
                link.body_frame(),
            )
            for link in links
        ]
        mass = plant.CalcMassMatrix(context)
        self.groups: list[np.ndarray] = []
        self.responses: list[np.ndarray] = []
        self.own = np.zeros((len(links), 6, 6))
        for count in sorted({len(found) for found in mechanisms.values()}):
            members = [found for found in mechanisms.values() if len(found) == count]
            found = [_response(mass, np.vstack([jacobians[number] for number in every])) for every in members]
            self.groups.append(np.array(members))
            self.responses.append(np.array(found))
            for every, response in zip(members, found, strict=True):
                for place, number in enumerate(every):
                    part = slice(6 * place, 6 * place + 6)
                    self.own[number] = response[part, part]

    def free_acceleration(self, motion: Motion) -> np.ndarray:
        """Return the accelerations of the links by all forces that are known: the derivative of ν (n×6).

        Args:
            motion: How the links move, and after them the `carried` bodies.
        """
        count = len(self.own)
        R_WL, origins = motion.R_WB[:count], motion.origins[:count]
        known = motion.applied[count:].reshape(-1, 2, 3)
        in_world = known @ motion.R_WB[count:].transpose(0, 2, 1)
        arms = motion.origins[count:] - origins[self._owners]
        wrenches = np.hstack([in_world[:, 0] + cross(arms, in_world[:, 1]), in_world[:, 1]])
        total = ((self._sums @ wrenches).reshape(-1, 2, 3) @ R_WL).reshape(-1, 6)
        fall = self._gravity @ R_WL
        total[:, :3] += cross(self._moments, fall)
        total[:, 3:] += self._masses * fall
        total -= coriolis(self._inertias, motion.V_B[:count])
        accelerations: np.ndarray = (self.own @ total[:, :, None])[:, :, 0]
        return accelerations


def _base(inboard: dict[BodyIndex, Joint], link: RigidBody) -> RigidBody:
    """Return the body of a link's mechanism that is jointed to the world."""
    body = link
    while int(inboard[body.index()].parent_body().index()) != 0:
        body = inboard[body.index()].parent_body()
    return body


def _carried(
    plant: MultibodyPlant, inboard: dict[BodyIndex, Joint], link: RigidBody, base: RigidBody
) -> list[RigidBody]:
    """Return the bodies that move with a link."""
    body = link
    if base.is_floating_base_body():
        body = base
    else:
        while inboard[body.index()].num_velocities() == 0 and body.index() != base.index():
            body = inboard[body.index()].parent_body()
    joint = inboard[body.index()]
    if joint.num_velocities() == 0:
        return [link]
    return [plant.get_body(index) for index in plant.GetBodiesKinematicallyAffectedBy([joint.index()])]


def _response(mass: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
    moving = np.flatnonzero(jacobian.any(axis=0))
    if not len(moving):
        return np.zeros((len(jacobian), len(jacobian)))
    coupled, count = moving, 0
    while len(coupled) > count:  # what does not move the link takes part in its response, too
        count = len(coupled)
        coupled = np.flatnonzero((mass[coupled] != 0).any(axis=0))
    part = np.ix_(coupled, coupled)
    try:
        response: np.ndarray = jacobian[:, coupled] @ np.linalg.solve(mass[part], jacobian[:, coupled].T)
    except np.linalg.LinAlgError:
        raise InputError("neither water nor wind can act on a mechanism without mass") from None
    return response
