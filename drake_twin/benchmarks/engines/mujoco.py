"""MuJoCo with its best settings for these robots: implicitfast integration, elliptic cones.

Wheels have velocity actuators, and arms actuators of integrated velocity, which hold a position.
"""

from pathlib import Path

import mujoco
import numpy as np

from drake_twin.benchmarks.boxes import Box
from drake_twin.benchmarks.engine import Setting
from drake_twin.benchmarks.robots import Prepared, prepare
from drake_twin.benchmarks.workloads import Workload

_ROBOT, _WORLD = 1, 2  # robots collide with the world only, not with each other, which saves MuJoCo time
_COMPILER = (
    '<mujoco><compiler strippath="false" discardvisual="true" fusestatic="true" balanceinertia="true"/></mujoco>'
)

# The twin's own gains (12,000 N·m·s/rad within 20 N·m) do not follow at steps of 1 or 2 ms. These do, at every step.
_SLIP = 0.1  # rad/s; the error of a wheel's velocity at which its actuator gives all of its effort
_DROOP = 0.002  # rad; the same for the position of an arm's joint
_LAG = 0.005  # s; of an arm's joint behind the integral of its command


class MujocoEngine:
    """The robots in one model."""

    def __init__(self, workload: Workload, count: int, folder: Path, setting: Setting):
        prepared = prepare(workload, count, folder, 0.001)
        spec = mujoco.MjSpec()
        spec.option.timestep = setting.step
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        ground = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[100, 100, 1])
        _collide(ground, _WORLD, _ROBOT | _WORLD)
        for index, box in enumerate(prepared.boxes):
            _add_box(spec, index, box)
        for index, robot in enumerate(prepared.robots):
            _add_robot(spec, index, robot)
        for geom in spec.geoms:
            geom.friction = [workload.friction, 0.0, 0.0]
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        names = [[f"{index}/{joint.name}" for joint in robot.joints] for index, robot in enumerate(prepared.robots)]
        self._positions = np.array([[self._model.joint(name).qposadr[0] for name in row] for row in names], dtype=int)
        self._actuators = np.array([[self._model.actuator(name).id for name in row] for row in names], dtype=int)
        free = [self._model.joint(f"box {index}").qposadr[0] for index in prepared.loose]
        self._loose = np.add.outer(np.array(free, dtype=int), np.arange(3))

    def command(self, velocities: np.ndarray) -> None:
        """Command joint velocities."""
        self._data.ctrl[self._actuators] = velocities

    def advance_to(self, time: float) -> None:
        """Advance to a time (s)."""
        steps = round((time - self._data.time) / self._model.opt.timestep)
        if steps > 0:
            mujoco.mj_step(self._model, self._data, steps)

    def reset(self, friction: float) -> None:
        """Return to time zero, with another coefficient of friction of all shapes."""
        mujoco.mj_resetData(self._model, self._data)
        self._model.geom_friction[:, 0] = friction

    def positions(self) -> np.ndarray:
        """Return the positions of the commanded joints."""
        return np.array(self._data.qpos[self._positions])

    def centers(self) -> np.ndarray:
        """Return the positions of the loose boxes' centers."""
        return np.array(self._data.qpos[self._loose])


def _add_robot(spec: mujoco.MjSpec, index: int, robot: Prepared) -> None:
    child = mujoco.MjSpec.from_string(robot.urdf.replace(">", f">{_COMPILER}", 1))
    for geom in child.geoms:
        geom.name = ""
        _collide(geom, _ROBOT, _WORLD)
    for joint in robot.description.movable_joints:
        if joint.mimic is not None:
            child.add_equality(
                type=mujoco.mjtEq.mjEQ_JOINT,
                name1=joint.name,
                name2=joint.mimic.joint,
                data=[joint.mimic.offset, joint.mimic.multiplier, *[0.0] * (mujoco.mjNEQDATA - 2)],
            )
    for commanded in robot.joints:
        actuator = child.add_actuator(name=commanded.name, target=commanded.name)
        actuator.trntype = mujoco.mjtTrn.mjTRN_JOINT
        if robot.description.joints_by_name[commanded.name].type == "continuous":
            actuator.set_to_velocity(kv=commanded.effort / _SLIP)
        else:
            stiffness = commanded.effort / _DROOP
            actuator.set_to_intvelocity(kp=stiffness, kv=stiffness * _LAG, inheritrange=1)
        actuator.forcelimited = True
        actuator.forcerange = [-commanded.effort, commanded.effort]
    frame = spec.worldbody.add_frame(pos=robot.xyz)
    spec.attach(child, prefix=f"{index}/", frame=frame)
    if not robot.plan.model.is_fixed:
        spec.body(f"{index}/{robot.plan.model.root_body}").add_freejoint()


def _add_box(spec: mujoco.MjSpec, index: int, box: Box) -> None:
    body = spec.worldbody.add_body(name=f"box {index}", pos=box.xyz, quat=box.quaternion)
    mass = {} if box.mass is None else {"mass": box.mass}
    geom = body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[edge / 2 for edge in box.size], **mass)
    _collide(geom, _WORLD, _ROBOT | _WORLD)
    if box.mass is not None:
        body.add_freejoint(name=body.name)


def _collide(geom: mujoco.MjsGeom, kind: int, others: int) -> None:
    geom.contype, geom.conaffinity = kind, others
