"""The history of an episode from logs that Drake keeps while it advances: no Python runs for a sample."""

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import LogVectorOutput, VectorLogSink

from drake_twin.cli.history import MOST_SAMPLES, SAMPLE_RATE, RobotHistory, RunHistory
from drake_twin.diagram.twin_diagram import DiagramParts
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.systems.plant_reading import physics_step
from drake_twin.twin.twin import Twin


class StateLog:
    """Logs a twin's state on a grid of simulation times; as an extension it is part of the twin's diagram.

    Args:
        with_efforts: Whether to log efforts, for which the plant solves a step; else they are zero.
    """

    def __init__(self, *, with_efforts: bool):
        self._with_efforts = with_efforts
        self._sinks: list[VectorLogSink] = []

    def __call__(self, builder: DiagramBuilder, parts: DiagramParts) -> None:
        """Add the logs to a diagram that is built."""
        step = physics_step(parts.plant)
        period = max(1, round(1.0 / SAMPLE_RATE / step)) * step if step else 1.0 / SAMPLE_RATE
        ports = [parts.plant.get_state_output_port()]
        if self._with_efforts:
            ports.append(parts.ports.net_actuation())
        self._sinks = [LogVectorOutput(port, builder, period) for port in ports]

    def restart(self, twin: Twin) -> None:
        """Forget what was logged, and log the present, for which a reset may have set values after its own sample."""
        for sink in self._sinks:
            sink.FindMutableLog(twin.context).Clear()
            sink.ForcedPublish(sink.GetMyContextFromRoot(twin.context))

    def history(self, twin: Twin) -> RunHistory:
        """Return what was logged; without real-time factors, of which an episode has none."""
        log = self._sinks[0].FindLog(twin.context)
        every = 1
        while log.num_samples() > MOST_SAMPLES * every:
            every *= 2
        data = [sink.FindLog(twin.context).data()[:, ::every].T.copy() for sink in self._sinks]
        times = log.sample_times()[::every].copy()
        robots = {plan.name: _of_robot(twin.plant, plan, times, *data) for plan in twin.built.plans}
        return RunHistory(robots, np.zeros(0), np.zeros(0))


def _of_robot(
    plant: MultibodyPlant, plan: RobotPlan, times: np.ndarray, states: np.ndarray, actuation: np.ndarray | None = None
) -> RobotHistory:
    instance = plant.GetModelInstanceByName(plan.name)
    movable = plan.description.movable_joints
    joints = [plant.GetJointByName(joint.name, instance) for joint in movable]
    efforts = np.zeros((len(times), len(joints)))
    if actuation is not None:
        actuators = map(plant.get_joint_actuator, plant.GetJointActuatorIndices(instance))
        columns = {actuator.joint().name(): actuator.input_start() for actuator in actuators}
        for column, joint in enumerate(movable):
            if joint.name in columns:
                efforts[:, column] = actuation[:, columns[joint.name]]
    return RobotHistory(
        joints=tuple(joint.name for joint in movable),
        units=tuple("m" if joint.type == "prismatic" else "rad" for joint in movable),
        times=times,
        positions=states[:, [joint.position_start() for joint in joints]],
        velocities=states[:, [plant.num_positions() + joint.velocity_start() for joint in joints]],
        efforts=efforts,
        base_poses=_base_poses(plant, plan, states[:, : plant.num_positions()]),
    )


def _base_poses(plant: MultibodyPlant, plan: RobotPlan, positions: np.ndarray) -> np.ndarray:
    """Return the root link's poses in the world (m): x, y, z, qw, qx, qy, qz, shape (samples, 7)."""
    root = plant.GetBodyByName(plan.model.root_body, plant.GetModelInstanceByName(plan.name))
    if root.is_floating_base_body() and root.has_quaternion_dofs():
        start = root.floating_positions_start()
        rotations = positions[:, start : start + 4]
        rotations = rotations / np.linalg.norm(rotations, axis=1, keepdims=True)
        rotations = np.where(rotations[:, :1] < 0, -rotations, rotations)  # as `RotationMatrix.ToQuaternion` has them
        return np.hstack([positions[:, start + 4 : start + 7], rotations])
    context = plant.CreateDefaultContext()
    poses = np.zeros((len(positions), 7))
    for index, q in enumerate(positions[:1] if plan.model.is_fixed else positions):
        plant.SetPositions(context, q)
        pose = plant.EvalBodyPoseInWorld(context, root)
        poses[index] = (*pose.translation(), *pose.rotation().ToQuaternion().wxyz())
    if plan.model.is_fixed:
        poses[:] = poses[:1]
    return poses
