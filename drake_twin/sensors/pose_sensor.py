"""The poses of links."""

from collections.abc import Sequence
from dataclasses import field

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import BasicVector, Context

from drake_twin.dataclass import dataclass
from drake_twin.sensors.plant_reader import PlantReader
from drake_twin.systems.weak_callback import weakly


@dataclass(frozen=True)
class MeasuredPose:
    """The pose of a frame P on a link B in a frame F on another link R.

    Attributes:
        body: B's body.
        reference: R's body; the world body for the world.
        X_BP: The pose of P in B.
        X_RF: The pose of F in R.
    """

    body: BodyIndex
    reference: BodyIndex
    X_BP: RigidTransform = field(default_factory=RigidTransform)
    X_RF: RigidTransform = field(default_factory=RigidTransform)


class PoseSensor(PlantReader):
    """Measure true poses of links. It has no ``<sensor>`` tag of its own.

    .. pydrake_system::

        name: PoseSensor
        input_ports:
        - body_poses
        output_ports:
        - poses

    - ``body_poses``: the plant's port of this name.
    - ``poses``: vector of ``[x y z, qx qy qz qw]`` (m) for each pose, computed on demand.

    Args:
        poses: What is measured.
    """

    def __init__(self, poses: Sequence[MeasuredPose]):
        super().__init__()
        self._measured = tuple((int(pose.body), int(pose.reference), pose.X_BP, pose.X_RF.inverse()) for pose in poses)
        self._poses = self.declare_plant_input("body_poses")
        self.DeclareVectorOutputPort("poses", 7 * len(self._measured), weakly(self._calc_poses), self.plant_tickets())

    def _calc_poses(self, context: Context, output: BasicVector) -> None:
        poses: list[RigidTransform] = self._poses.Eval(context)
        values = np.empty((len(self._measured), 7))
        for row, (body, reference, X_BP, X_FR) in zip(values, self._measured, strict=True):
            X_FP = X_FR @ poses[reference].inverse() @ poses[body] @ X_BP
            row[:3] = X_FP.translation()
            row[[6, 3, 4, 5]] = X_FP.rotation().ToQuaternion().wxyz()
        output.SetFromVector(values.ravel())
