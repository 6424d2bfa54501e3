"""The pose of a link."""

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import BasicVector, Context

from drake_twin.sensors.plant_reader import PlantReader
from drake_twin.systems.weak_callback import weakly


class PoseSensor(PlantReader):
    """Measure the true pose of a link in the world or in another link. It has no ``<sensor>`` tag of its own.

    .. pydrake_system::

        name: PoseSensor
        input_ports:
        - body_poses
        output_ports:
        - pose

    - ``body_poses``: the plant's port of this name.
    - ``pose``: vector ``[x y z, qx qy qz qw]`` (m), computed on demand.

    Args:
        body: The link's body.
        reference: The body in whose frame the pose is; the world body for the world.
    """

    def __init__(self, body: BodyIndex, reference: BodyIndex):
        super().__init__()
        self._body, self._reference = int(body), int(reference)
        self._poses = self.declare_plant_input("body_poses")
        self.DeclareVectorOutputPort("pose", 7, weakly(self._calc_pose), self.plant_tickets())

    def _calc_pose(self, context: Context, output: BasicVector) -> None:
        poses = self._poses.Eval(context)
        X_RB: RigidTransform = poses[self._reference].inverse() @ poses[self._body]
        w, x, y, z = X_RB.rotation().ToQuaternion().wxyz()
        output.SetFromVector(np.append(X_RB.translation(), [x, y, z, w]))
