"""The buoyancy of all links in a fluid, as gz-sim's Buoyancy has it."""

import numpy as np

from drake_twin.control.cross_product import cross
from drake_twin.control.submerged import SubmergedSolids
from drake_twin.controllers.body_forces import Motion
from drake_twin.controllers.world_forces import WorldBodies, WorldForces, world_forces
from drake_twin.description.plugins.buoyancy import BUOYANCY, BuoyancyParameters


@world_forces(BUOYANCY)
class BuoyancyForces(WorldForces):
    """The weight of the fluid that the links' collisions displace, at the center of its volume.

    Behaves as gz-sim's Buoyancy (from its sources), whose layers are level in the world's z. Where a surface crosses a
    shape, the part below it is exact for boxes, cylinders, meshes, spheres and ellipsoids in any orientation, where
    Gazebo Harmonic has boxes and spheres alone; capsules are surfaces of 48 sides with the volume of the shape. A
    mesh that is not closed counts as its convex hull. Layers add up: of all with a surface, each adds the part below
    it, times what the density there exceeds that above.
    """

    def __init__(self, parameters: BuoyancyParameters, world: WorldBodies):
        found = [(body.body, body.solids) for body in world.moving if body.solids and _floats(body.name, parameters)]
        self.bodies = [body for body, _ in found]
        solids = [(number, solid) for number, (_, every) in enumerate(found) for solid in every]
        self._owners = np.array([number for number, _ in solids], dtype=int)
        self._sums = np.zeros((len(found), len(solids)))
        self._sums[self._owners, np.arange(len(solids))] = 1.0
        self._solids = SubmergedSolids([solid for _, solid in solids])
        densities = [parameters.density, *(density for _, density in parameters.changes)]
        self._layers = [
            (height, below - above)
            for (height, _), below, above in zip(parameters.changes, densities, densities[1:], strict=False)
        ]
        # What the uppermost layer's density everywhere amounts to: kg, and kg·m in the bodies' frames.
        self._masses = densities[-1] * self._solids.volumes
        self._moments = self._masses[:, None] * self._solids.centers
        self._gravity = world.gravity

    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the buoyancy of each body."""
        del signals
        masses, moments = self._masses, self._moments
        if self._layers:
            up, heights = motion.R_WB[self._owners, 2], motion.origins[self._owners, 2]
            for height, excess in self._layers:
                volumes, shifts = self._solids.below(up, heights - height)
                masses, moments = masses + excess * volumes, moments + excess * shifts
        lift = -self._gravity @ motion.R_WB  # in the bodies' axes, for each kilogram
        force = (self._sums @ masses)[:, None] * lift
        return np.hstack([cross(self._sums @ moments, lift), force])


def _floats(name: str, parameters: BuoyancyParameters) -> bool:
    """Tell whether a link is enabled, or one of the models that it is in."""
    parts = name.split("::")
    above = {"::".join(parts[:count]) for count in range(1, len(parts) + 1)}
    return not parameters.enable or not above.isdisjoint(parameters.enable)
