"""DART as Gazebo sets it up: Dantzig's solver, ODE's collision detector, servo actuators, which take velocities.

Its friction is a pyramid whose sides are parallel to the world's axes. DART 6.20 can let bodies sleep, which neither
Gazebo's DART nor the twin does: that is off.
"""

import re
from pathlib import Path

import dartpy
import numpy as np

from drake_twin.benchmarks.boxes import FRICTION, Box
from drake_twin.benchmarks.engine import Setting
from drake_twin.benchmarks.robots import Prepared, prepare
from drake_twin.benchmarks.workloads import Workload

# Where the workload's origin stands in DART's world (m). ODE's broad phase loses pairs of bodies where one of them
# reaches through the plane z = 0, as each does that rests on a ground there: an arm then moves through a pillar.
_ORIGIN = np.array([100.0, 100.0, 10.0])


class DartEngine:
    """The robots in one world."""

    def __init__(self, workload: Workload, count: int, folder: Path, setting: Setting):
        prepared = prepare(workload, count, folder, 0.001)
        self._world = dartpy.simulation.World()
        self._world.setTimeStep(setting.step)
        self._step, self._steps = setting.step, 0
        self._world.getConstraintSolver().setCollisionDetector(dartpy.collision.OdeCollisionDetector())
        sleeping = self._world.getDeactivationOptions()
        sleeping.mEnabled = False
        self._world.setDeactivationOptions(sleeping)
        ground = dartpy.dynamics.Skeleton("ground")
        _, body = ground.createWeldJointAndBodyNodePair()
        _add_shape(body, dartpy.dynamics.PlaneShape([0, 0, 1], _ORIGIN[2]), workload.friction)
        self._world.addSkeleton(ground)
        boxes = [self._add_box(index, box, workload.friction) for index, box in enumerate(prepared.boxes)]
        self._loose = [boxes[index] for index in prepared.loose]
        self._joints = [self._add_robot(robot) for robot in prepared.robots]

    def command(self, velocities: np.ndarray) -> None:
        """Command joint velocities."""
        for joints, values in zip(self._joints, velocities.tolist(), strict=True):
            for joint, value in zip(joints, values, strict=True):
                joint.setCommand(0, value)

    def advance_to(self, time: float) -> None:
        """Advance to a time (s)."""
        steps, step = round(time / self._step), self._world.step
        for _ in range(steps - self._steps):
            step(False)  # commands hold
        self._steps = max(steps, self._steps)

    def positions(self) -> np.ndarray:
        """Return the positions of the commanded joints."""
        return np.array([[joint.getPosition(0) for joint in joints] for joints in self._joints])

    def centers(self) -> np.ndarray:
        """Return the positions of the loose boxes' centers."""
        return np.array([body.getWorldTransform().translation() - _ORIGIN for body in self._loose]).reshape(-1, 3)

    def _add_robot(self, robot: Prepared) -> list[dartpy.dynamics.Joint]:
        kind = dartpy.utils.DartLoaderRootJointType
        options = dartpy.utils.DartLoaderOptions()
        options.mDefaultRootJointType = kind.FIXED if robot.plan.model.is_fixed else kind.FLOATING
        loader = dartpy.utils.DartLoader()
        loader.setOptions(options)
        text = re.sub(r"<visual[ >].*?</visual>", "", robot.urdf, flags=re.DOTALL)
        skeleton = loader.parseSkeletonString(text, dartpy.common.Uri("file:///"))
        skeleton.setName(robot.plan.name)
        _place(skeleton.getRootJoint(), robot.xyz)
        for body in skeleton.getBodyNodes():
            for index in range(body.getNumShapeNodes()):
                body.getShapeNode(index).getDynamicsAspect().setFrictionCoeff(FRICTION)
        joints = [skeleton.getJoint(joint.name) for joint in robot.joints]
        for joint in joints:  # their limits of effort and velocity are the URDF's; a mimic joint is one already
            joint.setActuatorType(dartpy.dynamics.SERVO)
            joint.setLimitEnforcement(True)
        self._world.addSkeleton(skeleton)
        return joints

    def _add_box(self, index: int, box: Box, friction: float) -> dartpy.dynamics.BodyNode:
        skeleton = dartpy.dynamics.Skeleton(f"box {index}")
        if box.mass is None:
            joint, body = skeleton.createWeldJointAndBodyNodePair()
        else:
            joint, body = skeleton.createFreeJointAndBodyNodePair()
            body.setInertia(dartpy.dynamics.Inertia(box.mass, np.zeros(3), np.diag(box.inertia)))
        _place(joint, box.xyz, box.quaternion)
        _add_shape(body, dartpy.dynamics.BoxShape(box.size), friction)
        self._world.addSkeleton(skeleton)
        return body


def _place(root: dartpy.dynamics.Joint, xyz: tuple[float, float, float], wxyz: list[float] | None = None) -> None:
    pose = dartpy.math.Isometry3()
    pose.set_translation(np.add(_ORIGIN, xyz))
    if wxyz is not None:
        pose.set_quaternion(dartpy.math.Quaternion(*wxyz))
    root.setTransformFromParentBodyNode(pose)


def _add_shape(body: dartpy.dynamics.BodyNode, shape: dartpy.dynamics.Shape, friction: float) -> None:
    node = body.createShapeNode(shape)
    node.createCollisionAspect()
    node.createDynamicsAspect()
    node.getDynamicsAspect().setFrictionCoeff(friction)
