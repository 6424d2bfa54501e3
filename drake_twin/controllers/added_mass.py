"""Added mass of a fluid about links, as Gazebo's physics has it."""

from collections.abc import Sequence

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import Context

from drake_twin.control.fossen import coriolis
from drake_twin.controllers.body_forces import BodyForces, Motion
from drake_twin.controllers.fluid_response import FluidResponse


class AddedMassForces(BodyForces):
    """The forces that resist the acceleration of links with added mass, and its Coriolis forces.

    Gravity acts on the mass of the link alone, as in Gazebo.

    Args:
        plant: The finalized plant.
        links: The links.
        added: The added mass of each about its origin, in its axes (n×6×6), angular first.
        owners: What each belongs to, for errors.

    Raises:
        InputError: If an added mass takes all the mass of a link.
    """

    is_last = True

    def __init__(self, plant: MultibodyPlant, links: Sequence[RigidBody], added: np.ndarray, owners: Sequence[str]):
        self._added = added
        self._response = FluidResponse(plant, links, added, owners)
        self.bodies = self._response.bodies

    def follow(self, plant_context: Context) -> None:
        """Respond as links of other masses do."""
        self._response.follow(plant_context)

    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the wrench on each link; none on what it carries."""
        del signals
        count = len(self._added)
        return self._response.wrenches(motion, -coriolis(self._added, motion.V_B[:count]), ())
