"""What an IMU on a link measures."""

from typing import Any

import numpy as np
from pydrake.common.value import Value
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix
from pydrake.multibody.math import SpatialAcceleration, SpatialVelocity
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex
from pydrake.systems.framework import BasicVector, Context, InputPort, LeafSystem, OutputPort

from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.robot_description import Sensor
from drake_twin.systems.last_step import LastStep
from drake_twin.systems.weak_callback import weakly


class ImuSensor(LeafSystem):
    """Measures orientation, angular velocity and specific force at a place on a link, without noise.

    As gz-sim's Imu system: the linear acceleration has gravity in it, so that an IMU that lies still measures +9.81
    upwards, and the orientation is relative to a reference. It is computed when somebody asks.

    A discrete plant reports the accelerations of its last step, at the positions from which that step went out. They
    are turned back by what the link turned in the step, or a link that turns at 2 rad/s would see gravity lean by
    0.02 m/s² at 1 ms. Before the first step there are no accelerations, and the IMU measures as if it lay still.

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
        body: the link's body.
        pose: the sensor S in the body's frame B.
        reference: the frame that the orientation is relative to, in the world W.
        gravity: gravity in the world (m/s²).
        time_step: the plant's step (s); 0 for a continuous plant, whose accelerations are those of the present.
    """

    def __init__(
        self,
        body: BodyIndex,
        pose: RigidTransform,
        reference: RotationMatrix,
        gravity: np.ndarray,
        time_step: float,
    ):
        super().__init__()
        self._body = int(body)
        self._R_BS = pose.rotation()
        self._p_BS_B = np.array(pose.translation())
        self._R_RW = reference.inverse()
        self._gravity = np.array(gravity, dtype=float)
        self._time_step = time_step
        self._poses = self.DeclareAbstractInputPort("body_poses", Value[list[RigidTransform]]())
        self._velocities = self.DeclareAbstractInputPort("body_spatial_velocities", Value[list[SpatialVelocity]]())
        self._accelerations = self.DeclareAbstractInputPort(
            "body_spatial_accelerations", Value[list[SpatialAcceleration]]()
        )
        self._last_step = LastStep(self.DeclareAbstractState)
        self._spatial = self.DeclareVectorOutputPort(
            "spatial",
            10,
            weakly(self._calc_spatial),
            {self.input_port_ticket(port.get_index()) for port in (self._poses, self._velocities, self._accelerations)}
            | {self.abstract_state_ticket(self._last_step.index)},
        )

    @classmethod
    def of(cls, plant: MultibodyPlant, instance: ModelInstanceIndex, sensor: Sensor) -> "ImuSensor":
        """The IMU of a robot in a finalized plant, whose defaults are how the robot stands at the start."""
        body = plant.GetBodyByName(drake_link_name(sensor.link), instance)
        pose = RigidTransform(RollPitchYaw(*sensor.pose.rpy), np.array(sensor.pose.xyz))
        if sensor.orientation_reference is None:
            start = plant.EvalBodyPoseInWorld(plant.CreateDefaultContext(), body)
            reference = (start @ pose).rotation()
        else:
            reference = RotationMatrix(RollPitchYaw(*sensor.orientation_reference))
        time_step = plant.time_step() if plant.has_sampled_output_ports() else 0.0
        return cls(body.index(), pose, reference, plant.gravity_field().gravity_vector(), time_step)

    def inputs_from(self, plant: MultibodyPlant) -> tuple[tuple[OutputPort, InputPort], ...]:
        """Which of the plant's ports goes to which of its own."""
        return (
            (plant.get_body_poses_output_port(), self._poses),
            (plant.get_body_spatial_velocities_output_port(), self._velocities),
            (plant.get_body_spatial_accelerations_output_port(), self._accelerations),
        )

    def get_spatial_output_port(self) -> OutputPort:
        """The port ``spatial``."""
        return self._spatial

    def last_step(self, context: Context) -> np.ndarray:
        """What it measures that follows from the last step: the linear acceleration (m/s²)."""
        return np.asarray(self._spatial.Eval(context))[7:]

    def remember(self, context: Context, last_step: np.ndarray) -> None:
        """The linear acceleration at the present time, which a plant that has just been built does not know."""
        self._last_step.remember(context, last_step)

    def _calc_spatial(self, context: Context, output: BasicVector) -> None:
        R_WB: RotationMatrix = self._poses.Eval(context)[self._body].rotation()
        w_WB = np.array(self._velocities.Eval(context)[self._body].rotational())
        R_WS = R_WB @ self._R_BS
        orientation = (self._R_RW @ R_WS).ToQuaternion().wxyz()
        specific_force_S = self._last_step.recall(context)
        if specific_force_S is None:
            specific_force_S = self._specific_force(context, R_WB, w_WB)
        output.SetFromVector(np.concatenate([orientation, R_WS.matrix().T @ w_WB, specific_force_S]))

    def _specific_force(self, context: Context, R_WB: RotationMatrix, w_WB: np.ndarray) -> np.ndarray:
        A_WB = self._accelerations.Eval(context)[self._body]
        alpha_WB = np.array(A_WB.rotational())
        # At the start of the step that the accelerations are of:
        R_WB_then = _turn(-w_WB * self._time_step) @ R_WB.matrix()
        w_WB_then = w_WB - alpha_WB * self._time_step
        p_BS_W = R_WB_then @ self._p_BS_B
        a_WS = (
            np.array(A_WB.translational())
            + np.cross(alpha_WB, p_BS_W)
            + np.cross(w_WB_then, np.cross(w_WB_then, p_BS_W))
        )
        return np.asarray((R_WB_then @ self._R_BS.matrix()).T @ (a_WS - self._gravity))


def _turn(rotation_vector: np.ndarray) -> Any:
    """The rotation about a vector by its length (rad), as a matrix."""
    angle = float(np.linalg.norm(rotation_vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = rotation_vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
