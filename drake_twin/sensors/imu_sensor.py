"""An IMU on a link."""

import numpy as np
from pydrake.common.value import Value
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix
from pydrake.multibody.math import SpatialAcceleration, SpatialVelocity
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex
from pydrake.systems.framework import BasicVector, Context, InputPort, OutputPort

from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.robot_description import Sensor
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_system import SensorSystem
from drake_twin.systems.weak_callback import weakly


@sensor("imu")
class ImuSensor(SensorSystem):
    """Measure orientation, angular velocity and specific force at a point of a link, without noise.

    Like gz-sim's Imu system: the linear acceleration includes gravity, so that an IMU at rest measures +9.81 upwards,
    and the orientation is relative to a reference. The output is computed on demand.

    The plant's accelerations must be those of the present state, as a continuous plant's always are. A discrete plant's
    are without sampled output ports (``use_sampled_output_ports=False``), for the next step with the present commands.

    .. pydrake_system::

        name: ImuSensor
        input_ports:
        - body_poses
        - body_spatial_velocities
        - body_spatial_accelerations
        output_ports:
        - spatial

    - ``body_poses``, ``body_spatial_velocities``, ``body_spatial_accelerations``: the plant's ports of these names.
    - ``spatial``: vector ``[qw qx qy qz, wx wy wz, ax ay az]``: the sensor's orientation relative to its reference, its
      angular velocity (rad/s) and linear acceleration (m/s²) in its own axes.

    Args:
        body: The link's body.
        pose: The pose of the sensor S in the body's frame B.
        reference: The orientation in the world W of the frame that the output is relative to.
        gravity: Gravity in the world (m/s²).
    """

    size = 10

    def __init__(self, body: BodyIndex, pose: RigidTransform, reference: RotationMatrix, gravity: np.ndarray):
        super().__init__()
        self._body = int(body)
        self._R_BS = pose.rotation()
        self._p_BS_B = np.array(pose.translation())
        self._R_RW = reference.inverse()
        self._gravity = np.array(gravity, dtype=float)
        self._poses = self.DeclareAbstractInputPort("body_poses", Value[list[RigidTransform]]())
        self._velocities = self.DeclareAbstractInputPort("body_spatial_velocities", Value[list[SpatialVelocity]]())
        self._accelerations = self.DeclareAbstractInputPort(
            "body_spatial_accelerations", Value[list[SpatialAcceleration]]()
        )
        self._spatial = self.DeclareVectorOutputPort(
            "spatial",
            self.size,
            weakly(self._calc_spatial),
            {self.input_port_ticket(port.get_index()) for port in (self._poses, self._velocities, self._accelerations)},
        )

    @classmethod
    def of(cls, plant: MultibodyPlant, instance: ModelInstanceIndex, sensor: Sensor) -> "ImuSensor":
        """Return the IMU of a robot in a finalized plant, whose defaults are the robot's start state."""
        body = plant.GetBodyByName(drake_link_name(sensor.link), instance)
        pose = RigidTransform(RollPitchYaw(*sensor.pose.rpy), np.array(sensor.pose.xyz))
        if sensor.orientation_reference is None:
            start = plant.EvalBodyPoseInWorld(plant.CreateDefaultContext(), body)
            reference = (start @ pose).rotation()
        else:
            reference = RotationMatrix(RollPitchYaw(*sensor.orientation_reference))
        return cls(body.index(), pose, reference, plant.gravity_field().gravity_vector())

    def inputs_from(self, plant: MultibodyPlant) -> tuple[tuple[OutputPort, InputPort], ...]:
        """Return pairs of the plant's output ports and this system's input ports to connect."""
        return (
            (plant.get_body_poses_output_port(), self._poses),
            (plant.get_body_spatial_velocities_output_port(), self._velocities),
            (plant.get_body_spatial_accelerations_output_port(), self._accelerations),
        )

    def get_spatial_output_port(self) -> OutputPort:
        """Return the port ``spatial``."""
        return self._spatial

    def _calc_spatial(self, context: Context, output: BasicVector) -> None:
        R_WB: RotationMatrix = self._poses.Eval(context)[self._body].rotation()
        w_WB = np.array(self._velocities.Eval(context)[self._body].rotational())
        A_WB = self._accelerations.Eval(context)[self._body]
        R_WS = R_WB @ self._R_BS
        p_BS_W = R_WB.matrix() @ self._p_BS_B
        a_WS = (
            np.array(A_WB.translational())
            + np.cross(A_WB.rotational(), p_BS_W)
            + np.cross(w_WB, np.cross(w_WB, p_BS_W))
        )
        R_SW = R_WS.matrix().T
        orientation = (self._R_RW @ R_WS).ToQuaternion().wxyz()
        output.SetFromVector(np.concatenate([orientation, R_SW @ w_WB, R_SW @ (a_WS - self._gravity)]))
