"""The pose and the velocity of a frame on a link."""

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import BasicVector, Context

from drake_twin.sensors.plant_reader import PlantReader
from drake_twin.systems.weak_callback import weakly

SIZE = 13


class MotionSensor(PlantReader):
    """Measure the true pose and velocity in the world of a frame F on a link B. It has no ``<sensor>`` tag of its own.

    .. pydrake_system::

        name: MotionSensor
        input_ports:
        - body_poses
        - body_spatial_velocities
        output_ports:
        - motion

    - ``body_poses``, ``body_spatial_velocities``: the plant's ports of these names.
    - ``motion``: vector ``[x y z, qx qy qz qw, wx wy wz, vx vy vz]``, computed on demand: the pose in the world (m),
      the angular and the linear velocity in the world, in F's own axes (rad/s, m/s).

    Args:
        body: The link's body.
        X_BF: The pose of the frame in the link's.
    """

    def __init__(self, body: BodyIndex, X_BF: RigidTransform):
        super().__init__()
        self._body, self._X_BF = int(body), X_BF
        self._poses = self.declare_plant_input("body_poses")
        self._velocities = self.declare_plant_input("body_spatial_velocities")
        self.DeclareVectorOutputPort("motion", SIZE, weakly(self._calc_motion), self.plant_tickets())

    def _calc_motion(self, context: Context, output: BasicVector) -> None:
        X_WB: RigidTransform = self._poses.Eval(context)[self._body]
        V_WB: SpatialVelocity = self._velocities.Eval(context)[self._body]
        X_WF = X_WB @ self._X_BF
        V_WF = V_WB.Shift(X_WB.rotation() @ self._X_BF.translation())
        R_FW = X_WF.rotation().inverse()
        w, x, y, z = X_WF.rotation().ToQuaternion().wxyz()
        pose = np.append(X_WF.translation(), [x, y, z, w])
        output.SetFromVector(np.concatenate([pose, R_FW @ V_WF.rotational(), R_FW @ V_WF.translational()]))
