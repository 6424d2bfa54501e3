"""PyBullet with its velocity motors."""

from collections.abc import Sequence
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pybullet
from pybullet_utils.bullet_client import BulletClient

from drake_twin.benchmarks.boxes import FRICTION, Box
from drake_twin.benchmarks.engine import Setting
from drake_twin.benchmarks.robots import Prepared, prepare
from drake_twin.benchmarks.workloads import Workload


class PybulletEngine:
    """The robots in one physics client."""

    def __init__(self, workload: Workload, count: int, folder: Path, setting: Setting):
        self._bullet: Any = BulletClient(pybullet.DIRECT)
        prepared = prepare(workload, count, folder, 0.001)
        self._bullet.setGravity(0, 0, -9.81)
        self._bullet.setTimeStep(setting.step)
        self._step, self._steps = setting.step, 0
        # A pair's friction is the product: the robots have all of it, and boxes without robots the root.
        self._friction = 1.0 if workload.pile is None else sqrt(workload.friction)
        self._add_body(0.0, self._bullet.createCollisionShape(pybullet.GEOM_PLANE))
        boxes = [self._add_box(box) for box in prepared.boxes]
        self._loose = [boxes[index] for index in prepared.loose]
        self._robots = [self._add_robot(robot, folder) for robot in prepared.robots]

    def command(self, velocities: np.ndarray) -> None:
        """Command joint velocities."""
        for (robot, indices, efforts), values in zip(self._robots, velocities.tolist(), strict=True):
            self._bullet.setJointMotorControlArray(
                robot, indices, pybullet.VELOCITY_CONTROL, targetVelocities=values, forces=efforts
            )

    def advance_to(self, time: float) -> None:
        """Advance to a time (s)."""
        steps, step = round(time / self._step), self._bullet.stepSimulation
        for _ in range(steps - self._steps):
            step()
        self._steps = max(steps, self._steps)

    def positions(self) -> np.ndarray:
        """Return the positions of the commanded joints."""
        states = [self._bullet.getJointStates(robot, indices) for robot, indices, _ in self._robots]
        return np.array([[state[0] for state in row] for row in states])

    def centers(self) -> np.ndarray:
        """Return the positions of the loose boxes' centers."""
        return np.array([self._bullet.getBasePositionAndOrientation(box)[0] for box in self._loose]).reshape(-1, 3)

    def _add_robot(self, robot: Prepared, folder: Path) -> tuple[int, list[int], list[float]]:
        bullet = self._bullet
        file = folder / f"{robot.plan.name}.urdf"
        file.write_text(robot.urdf, encoding="utf-8")
        body = bullet.loadURDF(str(file), robot.xyz, useFixedBase=robot.plan.model.is_fixed)
        bullet.changeDynamics(body, -1, lateralFriction=FRICTION)
        indices = {}
        for index in range(bullet.getNumJoints(body)):
            indices[bullet.getJointInfo(body, index)[1].decode()] = index
            bullet.setJointMotorControl2(body, index, bullet.VELOCITY_CONTROL, force=0)
            bullet.changeDynamics(body, index, lateralFriction=FRICTION)
        for joint in robot.description.movable_joints:
            if joint.mimic is not None:  # a gear has no offset; the joints of these robots do not need one
                both = body, indices[joint.mimic.joint], body, indices[joint.name]
                gear = bullet.createConstraint(*both, bullet.JOINT_GEAR, joint.axis, (0, 0, 0), (0, 0, 0))
                bullet.changeConstraint(gear, gearRatio=-joint.mimic.multiplier, maxForce=100)
        return body, [indices[joint.name] for joint in robot.joints], [joint.effort for joint in robot.joints]

    def _add_box(self, box: Box) -> int:
        bullet = self._bullet
        shape = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=[edge / 2 for edge in box.size])
        return self._add_body(box.mass or 0.0, shape, box.xyz, np.roll(box.quaternion, -1).tolist())

    def _add_body(
        self, mass: float, shape: int, xyz: Sequence[float] = (0, 0, 0), quaternion: Sequence[float] = (0, 0, 0, 1)
    ) -> int:
        body: int = self._bullet.createMultiBody(mass, shape, -1, xyz, quaternion)
        self._bullet.changeDynamics(body, -1, lateralFriction=self._friction)
        return body
