"""The forces of a fluid on links: added mass without an algebraic loop, and damping that is stable at any step."""

from collections.abc import Sequence

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import Context

from drake_twin.controllers.body_forces import ForceController, Motion, RobotBody
from drake_twin.controllers.link_response import LinkResponse
from drake_twin.errors import InputError
from drake_twin.systems.plant_reading import physics_step

_LEAST = 1e-6  # of the mass of a link, what added mass has to leave of it


class FluidResponse:
    """Make wrenches of what a fluid does to links.

    With ν the link's velocity in its own axes and ν_r that relative to the fluid, Fossen's equations are

        M ν' + C(ν) ν = F - D(ν_r) ν_r - M_A ν_r' - C_A(ν_r) ν_r.

    As F - C ν the sum of all other known forces is taken, and W in place of M⁻¹ (`LinkResponse`). Then

        ν' = (1 + W M_A)⁻¹ (ν'₀ + W F_w),  F_w = -D ν_r - C_A ν_r,

    without an algebraic loop: nothing here depends on what the plant's solver finds. For a free body it is exact, with
    M_A of any size, where a force of minus M_A times the last step's acceleration, as in Gazebo, diverges where M_A
    exceeds M. Contacts and motors act on the link as if it had no added mass.

    Over a step h, damping is that of the exponential Euler method: the step's mean acceleration is φ(-h K) ν', with K
    what ν' loses with ν. With (1 + X + X²/2)⁻¹ in place of exp(-X) (Padé's, second order, L-stable) that is

        (1 + X + X²/2)⁻¹ (1 + X/2) ν',  X = h K.

    So terminal velocities do not depend on the step, a decay is right to second order, and damping of any size stops a
    link within a step, but never turns it round. The wrench is then F_w - M_A ν' and what the mean lacks of it, from
    which no inverse of W is needed: a link that cannot move has a W that is singular.

    Args:
        plant: The finalized plant.
        links: The links.
        added: The added mass of each link about its origin, in its axes (n×6×6), angular first; None for none.
        owners: What gives each its added mass, for errors.

    Raises:
        InputError: If an added mass takes all the mass of a link.

    Attributes:
        bodies: The links, and then the bodies that they carry.
    """

    def __init__(
        self,
        plant: MultibodyPlant,
        links: Sequence[RigidBody],
        added: np.ndarray | None = None,
        owners: Sequence[str] = (),
    ):
        self._links, self._plant = links, plant
        self._added = np.zeros((len(links), 6, 6)) if added is None else added
        self._step = physics_step(self._plant)
        self.follow(None)
        self.bodies: list[RigidBody] = [*self._links, *self._response.carried]
        for (members, *_), response in zip(self._groups, self._response.responses, strict=True):
            effective = np.eye(response.shape[-1]) + response @ _blocks(self._added, members)
            for every in members[np.linalg.eigvals(effective).real.min(axis=1) < _LEAST]:
                what = "is negative and takes all of its mass; SNAME's xDotU is negative"
                raise InputError(f"{owners[every[0]]}: the added mass of link {links[every[0]].name()!r} {what}")

    @classmethod
    def of(cls, sources: Sequence[tuple[ForceController, RobotBody]], added: np.ndarray) -> "FluidResponse":
        """Return that of the links of controllers, which have a parameter ``link_name``, and their robots."""
        plant = sources[0][1].plant
        links = [body.link(source.setup.parameters.link_name) for source, body in sources]
        robots = (plant.GetModelInstanceName(body.instance) for _, body in sources)
        names = (source.setup.name for source, _ in sources)
        owners = [f"robot {robot!r}: controller {name}" for robot, name in zip(robots, names, strict=True)]
        return cls(plant, links, added, owners)

    def follow(self, masses: Context | None) -> None:
        """Respond as links with the masses in a context of the plant do; without one as those as built."""
        self._response = LinkResponse(self._plant, self._links, masses)
        self._groups = []
        for members, response in zip(self._response.groups, self._response.responses, strict=True):
            mass = _blocks(self._added, members)
            unit = np.eye(response.shape[-1])
            after = np.linalg.inv(unit + response @ mass)
            before = np.linalg.inv(unit + mass @ response)
            self._groups.append((members, unit, after, after @ response, before))

    def losses(self, slope: np.ndarray) -> list[np.ndarray]:
        """Return what wrenches lose for each acceleration at the start of a step, by group (g×6k×6k).

        Args:
            slope: How much smaller the wrench F_w on each link becomes with each velocity (n×6×6).
        """
        found = []
        for members, unit, _, mobility, before in self._groups if self._step > 0.0 else ():
            slopes = self._step * _blocks(slope, members)
            X = mobility @ slopes
            half = unit + X / 2
            stepped = np.linalg.solve(unit + X @ half, half)
            found.append(before @ (slopes @ (half @ stepped - unit / 2)))
        return found

    def wrenches(self, motion: Motion, fluid: np.ndarray, losses: Sequence[np.ndarray]) -> np.ndarray:
        """Return the wrench on each of the `bodies`; none on what links carry.

        Args:
            motion: How the `bodies` move.
            fluid: The wrench F_w on each link (n×6).
            losses: Its `losses`.
        """
        free = self._response.free_acceleration(motion)
        found = np.zeros_like(motion.V_B)
        found[: len(fluid)] = fluid
        for number, (members, _, after, mobility, _) in enumerate(self._groups):
            own = fluid[members].reshape(len(members), -1, 1)
            mean = after @ free[members].reshape(len(members), -1, 1) + mobility @ own
            found[members] -= (self._added[members] @ mean.reshape(*members.shape, 6, 1))[..., 0]
            if losses:
                found[members] -= (losses[number] @ mean).reshape(*members.shape, 6)
        return found


def _blocks(matrices: np.ndarray, members: np.ndarray) -> np.ndarray:
    """Return matrices (n×6×6) of the members of groups (g×k) as block diagonals (g×6k×6k)."""
    count = members.shape[1]
    found = np.zeros((len(members), 6 * count, 6 * count))
    for place in range(count):
        part = slice(6 * place, 6 * place + 6)
        found[:, part, part] = matrices[members[:, place]]
    return found
