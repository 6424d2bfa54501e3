"""A force/torque sensor in a joint."""

import numpy as np
from pydrake.common.value import Value
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Joint, ModelInstanceIndex
from pydrake.systems.framework import BasicVector, Context, InputPort, OutputPort

from drake_twin.description.robot_description import Sensor
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.sensor_system import SensorSystem
from drake_twin.systems.weak_callback import weakly


@sensor("force_torque", on="joint")
class ForceTorqueSensor(SensorSystem):
    """Measure the wrench that a joint's two links exert on each other, without noise.

    Like gz-sim's ForceTorque system: the torque is about the sensor's origin, the axes are those of the child link, the
    parent link or the sensor, and the wrench is the child's on the parent (SDF's ``child_to_parent``, the default) or
    the parent's on the child. It includes the actuator's effort. It is computed on demand. A discrete plant without
    sampled output ports reports the forces of the next step with the present commands.

    .. pydrake_system::

        name: ForceTorqueSensor
        input_ports:
        - reaction_forces
        - body_poses
        output_ports:
        - wrench

    - ``reaction_forces``: the plant's port of this name.
    - ``body_poses``: the plant's port of this name; only declared for the axes of the parent link.
    - ``wrench``: vector ``[fx fy fz, tx ty tz]`` (N, N·m).

    Args:
        joint: The joint.
        pose: The pose of the sensor S in the joint's frame J, which moves with the child link C.
        measured_on: The link that the measured wrench acts on: ``parent`` or ``child``.
        axes: ``child``, ``parent`` or ``sensor``.
    """

    size = 6

    def __init__(self, joint: Joint, pose: RigidTransform, measured_on: str = "parent", axes: str = "child"):
        super().__init__()
        self._joint = int(joint.index())
        self._parent, self._child = int(joint.parent_body().index()), int(joint.child_body().index())
        self._p_JS_J = np.array(pose.translation())
        self._sign = {"parent": -1.0, "child": 1.0}[measured_on]
        R_CJ = joint.frame_on_child().GetFixedPoseInBodyFrame().rotation()
        self._R_CJ = R_CJ.matrix()
        self._R_AJ = {"child": R_CJ, "parent": R_CJ, "sensor": pose.rotation().inverse()}[axes].matrix()
        self._forces = self.DeclareAbstractInputPort("reaction_forces", Value[list[SpatialForce]]())
        ports = [self._forces]
        self._poses: InputPort | None = None
        if axes == "parent":
            self._poses = self.DeclareAbstractInputPort("body_poses", Value[list[RigidTransform]]())
            ports.append(self._poses)
        self._wrench = self.DeclareVectorOutputPort(
            "wrench",
            self.size,
            weakly(self._calc_wrench),
            {self.input_port_ticket(port.get_index()) for port in ports},
        )

    @classmethod
    def of(cls, plant: MultibodyPlant, instance: ModelInstanceIndex, sensor: Sensor) -> "ForceTorqueSensor":
        """Return the sensor of a robot in a finalized plant."""
        pose = RigidTransform(RollPitchYaw(*sensor.pose.rpy), np.array(sensor.pose.xyz))
        return cls(plant.GetJointByName(sensor.joint, instance), pose, sensor.measured_on, sensor.axes)

    def inputs_from(self, plant: MultibodyPlant) -> tuple[tuple[OutputPort, InputPort], ...]:
        """Return pairs of the plant's output ports and this system's input ports to connect."""
        forces = (plant.get_reaction_forces_output_port(), self._forces)
        return (forces,) if self._poses is None else (forces, (plant.get_body_poses_output_port(), self._poses))

    def get_wrench_output_port(self) -> OutputPort:
        """Return the port ``wrench``."""
        return self._wrench

    def _calc_wrench(self, context: Context, output: BasicVector) -> None:
        F_CJ_J = self._forces.Eval(context)[self._joint]
        force = np.array(F_CJ_J.translational())
        torque = np.array(F_CJ_J.rotational()) - np.cross(self._p_JS_J, force)
        R_AJ = self._R_AJ
        if self._poses is not None:
            poses = self._poses.Eval(context)
            R_PC = poses[self._parent].rotation().inverse() @ poses[self._child].rotation()
            R_AJ = R_PC.matrix() @ self._R_CJ
        output.SetFromVector(self._sign * np.concatenate([R_AJ @ force, R_AJ @ torque]))
