"""The forces of the wind on links, as gz-sim's WindEffects has them."""

import numpy as np
from pydrake.math import VectorToSkewSymmetric
from pydrake.systems.framework import Context

from drake_twin.control.scalar_field import ScalarField
from drake_twin.controllers.body_forces import Motion
from drake_twin.controllers.fluid_response import FluidResponse
from drake_twin.controllers.world_forces import WorldBodies, WorldForces, world_forces
from drake_twin.description.plugins.wind import WindEffectsParameters
from drake_twin.description.world_plugins import WIND_EFFECTS


@world_forces(WIND_EFFECTS)
class WindForces(WorldForces):
    """A force on each link with ``<enable_wind>``: its mass times its velocity relative to the wind and a factor.

    Behaves as gz-sim's WindEffects (from its sources): the velocity is that of the link's origin, and the force acts at
    its center of mass. Of the factor, a number counts as itself, where gz-sim takes its square. The force is that of
    the whole step, so that a factor of any size is stable, see `FluidResponse`.
    """

    is_last = True
    has_wind_signal = True

    def __init__(self, parameters: WindEffectsParameters, world: WorldBodies):
        context = world.plant.CreateDefaultContext()
        self._links = [item.body for item in world.moving if item.feels_wind and item.body.get_mass(context) > 0.0]
        self.bodies = []
        if self._links:
            self._field = ScalarField(parameters.scaling)
            self._response = FluidResponse(world.plant, self._links)
            self.bodies = self._response.bodies
            self._prepare(context)

    def follow(self, plant_context: Context) -> None:
        """Push and respond as links of other masses do."""
        self._response.follow(plant_context)
        self._prepare(plant_context)

    def _prepare(self, plant_context: Context) -> None:
        wrenches = []
        for link in self._links:
            center = link.CalcCenterOfMassInBodyFrame(plant_context)
            unit = np.vstack([VectorToSkewSymmetric(center), np.eye(3)])
            wrenches.append(link.get_mass(plant_context) * unit)
        self._wrenches = np.array(wrenches)  # of 1 m/s, with a factor of 1
        self._slopes = np.concatenate([np.zeros_like(self._wrenches), self._wrenches], axis=2)
        constant = self._field.constant
        self._losses = None if constant is None else self._response.losses(constant * self._slopes)

    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the wrench of the wind on each link; none on what it carries."""
        if not signals[0]:
            return np.zeros((len(self.bodies), 6))
        count = len(self._links)
        flow = -motion.V_B[:count, 3:]
        if motion.wind is not None:
            flow += motion.wind @ motion.R_WB[:count]
        pushed = (self._wrenches @ flow[:, :, None])[:, :, 0]
        if (factor := self._field.constant) is not None:
            assert self._losses is not None
            return self._response.wrenches(motion, factor * pushed, self._losses)
        factors = self._field.at(motion.origins[:count])
        losses = self._response.losses(factors[:, None, None] * self._slopes)
        return self._response.wrenches(motion, factors[:, None] * pushed, losses)
