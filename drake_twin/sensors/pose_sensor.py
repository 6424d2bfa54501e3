"""The pose of a link."""

import numpy as np
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import BasicVector, Context, InputPort, OutputPort

from drake_twin.sensors.sensor_system import SensorSystem
from drake_twin.systems.weak_callback import weakly


class PoseSensor(SensorSystem):
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

    size = 7

    def __init__(self, body: BodyIndex, reference: BodyIndex):
        super().__init__()
        self._body, self._reference = int(body), int(reference)
        self._poses: InputPort = self.DeclareAbstractInputPort("body_poses", Value[list[RigidTransform]]())
        self.DeclareVectorOutputPort(
            "pose", self.size, weakly(self._calc_pose), {self.input_port_ticket(self._poses.get_index())}
        )

    def inputs_from(self, plant: MultibodyPlant) -> tuple[tuple[OutputPort, InputPort], ...]:
        """Return pairs of the plant's output ports and this system's input ports to connect."""
        return ((plant.get_body_poses_output_port(), self._poses),)

    def _calc_pose(self, context: Context, output: BasicVector) -> None:
        poses = self._poses.Eval(context)
        X_RB: RigidTransform = poses[self._reference].inverse() @ poses[self._body]
        w, x, y, z = X_RB.rotation().ToQuaternion().wxyz()
        output.SetFromVector(np.append(X_RB.translation(), [x, y, z, w]))
