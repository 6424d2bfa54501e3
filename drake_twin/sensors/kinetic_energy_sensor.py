"""The kinetic energy of a link."""

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.tree import BodyIndex, SpatialInertia
from pydrake.systems.framework import BasicVector, Context

from drake_twin.sensors.plant_reader import PlantReader
from drake_twin.systems.weak_callback import weakly


class KineticEnergySensor(PlantReader):
    """Measure the true kinetic energy of a link B in the world. It has no ``<sensor>`` tag of its own.

    .. pydrake_system::

        name: KineticEnergySensor
        input_ports:
        - body_poses
        - body_spatial_velocities
        output_ports:
        - energy

    - ``body_poses``, ``body_spatial_velocities``: the plant's ports of these names.
    - ``energy``: vector of one element (J), computed on demand.

    Args:
        body: The link's body.
        M_BBo_B: Its spatial inertia about its origin, in its axes.
    """

    def __init__(self, body: BodyIndex, M_BBo_B: SpatialInertia):
        super().__init__()
        self._body, self._inertia = int(body), M_BBo_B.CopyToFullMatrix6()
        self._poses = self.declare_plant_input("body_poses")
        self._velocities = self.declare_plant_input("body_spatial_velocities")
        self.DeclareVectorOutputPort("energy", 1, weakly(self._calc_energy), self.plant_tickets())

    def _calc_energy(self, context: Context, output: BasicVector) -> None:
        X_WB: RigidTransform = self._poses.Eval(context)[self._body]
        V_WB: SpatialVelocity = self._velocities.Eval(context)[self._body]
        R_BW = X_WB.rotation().inverse()
        V = np.concatenate([R_BW @ V_WB.rotational(), R_BW @ V_WB.translational()])
        output.SetFromVector([0.5 * float(V @ self._inertia @ V)])
